// Jobs to start from: a finger that is solved in seconds, and one that holds a tube, in less than a minute.
export const finger = `{
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

export const grasp = `{
  "kind": "grasp",
  "name": "a finger around a tube",
  "actuator": {
    "family": "pneunet",
    "length": "76 mm", "width": "20 mm", "height": "15.6 mm",
    "chambers": [ { "config": "B", "count": 8 } ],
    "chamber_gap": "2 mm", "side_wall": "2 mm", "top_wall": "1.5 mm", "bottom_layer": "4 mm"
  },
  "material": "dragon-skin-30",
  "load": { "pressure": { "to": "40 kPa", "steps": 8 } },
  "object": {
    "shape": { "form": "cylinder", "diameter": "30 mm", "length": "40 mm" },
    "position": [ "40 mm", 0, "-16 mm" ], "axis": [ 0, 1, 0 ],
    "friction": 0.6
  },
  "grasp": { "pull": { "direction": [ 1, 0, 0 ], "distance": "30 mm", "rate": "5 mm/s", "steps": 30 } },
  "accuracy": "draft"
}
`;
