// A job that is solved in seconds, to start from.
export const example = `{
  "kind": "response",
  "name": "a first finger",
  "actuator": {
    "family": "pneunet",
    "length": "58 mm", "width": "20 mm", "height": "15.6 mm",
    "chambers": [ { "config": "B", "count": 6 } ],
    "chamber_gap": "2 mm", "side_wall": "2 mm", "top_wall": "1.5 mm", "bottom_layer": "4 mm"
  },
  "material": "elastic-50a",
  "load": { "pressure": { "to": "30 kPa", "steps": 6 } },
  "accuracy": "fast"
}
`;
