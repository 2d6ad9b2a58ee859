"""Reads back the files of a run and compares them with its result document and each other.

    check_files.py RESULT.json DIRECTORY

Knows the file formats from their descriptions only: VTK's XML with zlib blocks, RFC 4180.
"""
import base64
import csv
import json
import math
import os
import re
import struct
import sys
import xml.etree.ElementTree as xml
import zlib

failures = 0


def check(what, holds):
    global failures
    if not holds:
        failures += 1
        print("FAILED:", what)


def near(a, b, tolerance):
    return abs(a - b) <= tolerance


# ---- VTU ----

def decode(array):
    """Numbers of a DataArray: a base64 header of UInt64, then the base64 zlib blocks."""
    text = "".join(array.text.split())
    blocks = struct.unpack("<Q", base64.b64decode(text[:12])[:8])[0]
    size = 8 * (3 + blocks)
    length = 4 * ((size + 2) // 3)
    header = struct.unpack("<%dQ" % (3 + blocks), base64.b64decode(text[:length])[:size])
    packed = base64.b64decode(text[length:])
    data, start = b"", 0
    for compressed in header[3:]:
        data += zlib.decompress(packed[start:start + compressed])
        start += compressed
    letter, width = {"Float32": ("f", 4), "Int32": ("i", 4), "UInt8": ("B", 1)}[array.get("type")]
    return struct.unpack("<%d%s" % (len(data) // width, letter), data)


class Grid:
    def __init__(self, path):
        root = xml.parse(path).getroot()
        check(path + ": header", root.get("byte_order") == "LittleEndian"
              and root.get("header_type") == "UInt64"
              and root.get("compressor") == "vtkZLibDataCompressor")
        piece = root.find("UnstructuredGrid/Piece")
        self.points = triples(decode(piece.find("Points/DataArray")))
        cells = {a.get("Name"): decode(a) for a in piece.find("Cells")}
        ends = cells["offsets"]
        self.cells = [cells["connectivity"][b:e] for b, e in zip((0,) + ends, ends)]
        self.types = set(cells["types"])
        self.data = {}
        for a in piece.find("PointData"):
            values = decode(a)
            n = int(a.get("NumberOfComponents"))
            self.data[a.get("Name")] = (values if n == 1 else
                                        [values[i:i + n] for i in range(0, len(values), n)])
            check(path + ": finite " + a.get("Name"), all(map(math.isfinite, values)))
        count = int(piece.get("NumberOfPoints"))
        check(path + ": counts", len(self.points) == count
              and len(self.cells) == int(piece.get("NumberOfCells")) > 0
              and len(cells["types"]) == len(self.cells)
              and all(len(v) == count for v in self.data.values())
              and all(0 <= n < count for c in self.cells for n in c))


def triples(values):
    return [values[i:i + 3] for i in range(0, len(values), 3)]


# Places of VTK's nodes in the unit cube: corners, edges, faces, centre; and in the unit square.
CORNERS = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
EDGES = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6),
         (3, 7)]
H = 0.5
HEX = (CORNERS + [tuple((CORNERS[a][i] + CORNERS[b][i]) / 2 for i in range(3)) for a, b in EDGES]
       + [(0, H, H), (1, H, H), (H, 0, H), (H, 1, H), (H, H, 0), (H, H, 1), (H, H, H)])
QUAD = [(0, 0), (1, 0), (1, 1), (0, 1), (H, 0), (1, H), (H, 1), (0, H), (H, H)]
GAUSS = [(H - H * math.sqrt(0.6), 5 / 18), (H, 8 / 18), (H + H * math.sqrt(0.6), 5 / 18)]


def lagrange(node, x):
    """Quadratic function of the node 0, 1/2 or 1 at x, and its derivative."""
    if node == 0:
        return (2 * x - 1) * (x - 1), 4 * x - 3
    if node == 1:
        return x * (2 * x - 1), 4 * x - 1
    return 4 * x * (1 - x), 4 - 8 * x


def shapes(places, at):
    """Derivatives of all shape functions at a point, per direction; and the functions."""
    values, slopes = [], [[] for _ in at]
    for place in places:
        line = [lagrange(p, x) for p, x in zip(place, at)]
        values.append(math.prod(v for v, _ in line))
        for d in range(len(at)):
            slopes[d].append(math.prod(line[k][k == d] for k in range(len(at))))
    return values, slopes


def products(dimension):
    if dimension == 0:
        return [((), 1.0)]
    return [(at + (x,), w * v) for at, w in products(dimension - 1) for x, v in GAUSS]


HEX_POINTS = [shapes(HEX, at) + (w,) for at, w in products(3)]
QUAD_POINTS = [shapes(QUAD, at) + (w,) for at, w in products(2)]


def combine(weights, points):
    return [sum(w * p[i] for w, p in zip(weights, points)) for i in range(3)]


def triple(a, b, c):
    return (a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2])
            + a[2] * (b[0] * c[1] - b[1] * c[0]))


def volume(grid):
    """Volume of the hexahedra, and the smallest Jacobian relative to the cell's mean."""
    total, least = 0, math.inf
    for cell in grid.cells:
        points = [grid.points[n] for n in cell]
        jacobians = [triple(*(combine(s, points) for s in slopes)) for _, slopes, _ in HEX_POINTS]
        size = sum(w * j for (_, _, w), j in zip(HEX_POINTS, jacobians))
        total += size
        least = min(least, min(jacobians) / abs(size))
    return total, least


def enclosed(grid):
    """A third of the surface integral of x . n: the volume when the surface is closed and its
    normals point out of the solid."""
    total = 0
    for cell in grid.cells:
        points = [grid.points[n] for n in cell]
        for values, (s, t), w in QUAD_POINTS:
            total += w * triple(combine(values, points), combine(s, points),
                                combine(t, points)) / 3
    return total


def check_stress(name, grid):
    data = grid.data
    largest = max(data["von_mises_kPa"])
    for k in range(0, len(grid.points), 7):
        xx, yy, zz, xy, yz, xz = data["cauchy_stress_kPa"][k]
        tolerance = 1e-5 * (largest + 1)
        mean = (xx + yy + zz) / 3
        check(name + ": hydrostatic pressure",
              near(data["hydrostatic_pressure_kPa"][k], -mean, tolerance))
        square = (((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2) / 2
                  + 3 * (xy ** 2 + yz ** 2 + xz ** 2))
        mises = data["von_mises_kPa"][k]
        check(name + ": von Mises", near(mises, math.sqrt(square), 3 * tolerance))
        # Principal stresses lie between 1/3 and 2/3 of von Mises above the mean.
        above = data["largest_principal_stress_kPa"][k] - mean
        check(name + ": principal", mises / 3 - 3 * tolerance <= above
              <= 2 * mises / 3 + 3 * tolerance)
        p = data["largest_principal_stress_kPa"][k]
        determinant = triple((xx - p, xy, xz), (xy, yy - p, yz), (xz, yz, zz - p))
        check(name + ": characteristic", abs(determinant) <= 1e-4 * (largest + 1) ** 3)


def check_series(result, directory, kind, tip):
    collection = xml.parse(os.path.join(directory, kind + ".pvd")).getroot().findall(
        "Collection/DataSet")
    samples = result["samples"]
    solid = result["metrics"]["mass_g"] / DENSITY * 1e6  # mm3
    check(kind + ".pvd: a file a sample", len(collection) == len(samples))
    for entry, sample in zip(collection, samples):
        name = entry.get("file")
        check(name + ": time is pressure", near(float(entry.get("timestep")),
                                                sample["pressure_kPa"], 1e-9))
        check(name + " is an artifact", name in result["artifacts"])
        grid = Grid(os.path.join(directory, name))
        data = grid.data
        rest = sample is samples[0]
        check(name + ": stretch", max(data["stretch"]) <= sample["max_stretch"] + 1e-5
              and max(data["stretch"]) - 1 >= 0.5 * (sample["max_stretch"] - 1) - 1e-5)
        check_stress(name, grid)
        contact = max(data["contact_pressure_kPa"])
        check(name + ": contact pressure", min(data["contact_pressure_kPa"]) >= 0
              and (contact > 0.1) == (sample["min_gap_mm"] < 1e-2))
        if rest:
            check(name + ": at rest", max(map(abs, sum(data["displacement_mm"], ()))) < 1e-6)
        if kind == "volume":
            check(name + ": cell type", grid.types == {29})
            size, least = volume(grid)
            check(name + ": right-handed cells", least > 0)
            check(name + ": the tip", all(near(a, sample[b], 1e-4) for a, b in zip(
                grid.points[tip], ("tip_x_mm", "tip_y_mm", "tip_z_mm"))))
            size *= 2  # half of the body
        else:
            check(name + ": cell type", grid.types == {28})
            size = enclosed(grid)
            check(name + ": mirrored", near(sum(p[1] for p in grid.points), 0, 1e-2))
        check("%s: volume %g against %g" % (name, size, solid),
              near(size, solid, (2e-6 if rest else 2e-3) * solid))


# ---- tables and deck ----

def check_samples(result, directory):
    path = os.path.join(directory, "samples.csv")
    text = open(path, newline="").read()
    check("samples.csv: lines end with CRLF", text.count("\n") == text.count("\r\n") > 0)
    rows = list(csv.DictReader(open(path, newline="")))
    check("samples.csv: rows", len(rows) == len(result["samples"]))
    for row, sample in zip(rows, result["samples"]):
        check("samples.csv: columns", set(sample) <= set(row))
        for key, text in row.items():
            if key in sample:
                check("samples.csv: " + key,
                      near(float(text), sample[key], 1e-9 * (1 + abs(sample[key]))))
            else:
                check("samples.csv: empty " + key, text == "")


def check_midlines(result, directory):
    rows = list(csv.DictReader(open(os.path.join(directory, "midlines.csv"), newline="")))
    expected = [(m["pressure_kPa"], k, p) for m in result["midlines"]
                for k, p in enumerate(m["points_mm"])]
    check("midlines.csv: rows", len(rows) == len(expected))
    length, before = 0, None
    for row, (pressure, k, point) in zip(rows, expected):
        length = 0 if k == 0 else length + math.dist(before, point)
        before = point
        wanted = [pressure, k, length] + point
        got = [float(row[key]) for key in ("pressure_kPa", "point", "arc_length_mm", "x_mm",
                                           "y_mm", "z_mm")]
        check("midlines.csv: %s" % row, all(near(a, b, 1e-7 * (1 + abs(b)))
                                            for a, b in zip(got, wanted)))


def check_deck(directory):
    """Returns the point of the volume that is the node TIP."""
    text = open(os.path.join(directory, "model.inp")).read()
    for card in ("*NODE, NSET=NALL", "*ELEMENT, TYPE=C3D20R, ELSET=EALL", "*NSET, NSET=FIXED",
                 "*NSET, NSET=SYMMETRY", "*SURFACE, NAME=CAVITY, TYPE=ELEMENT",
                 "*SURFACE, NAME=OUTER, TYPE=ELEMENT", "*DSLOAD\nCAVITY, P, "):
        check("model.inp has " + card, text.count(card) == 1)
    return int(re.search(r"\*NSET, NSET=TIP\n(\d+)", text).group(1)) - 1


def unpack_rows(data, rows, count, size):
    """Values of rows of `count` numbers whose bytes are stored lowest first, all of one rank at a time."""
    out = []
    for r in range(rows):
        row = data[r * count * size:(r + 1) * count * size]
        planes = [row[b * count:(b + 1) * count] for b in range(size)]
        out.append([sum(planes[b][k] << 8 * b for b in range(size)) for k in range(count)])
    return out


def check_recording(directory, surface, samples):
    """surface.bin, read by its description, against surface.json."""
    data = open(os.path.join(directory, "surface.bin"), "rb").read()
    length = struct.unpack_from("<I", data, 8)[0]
    head = json.loads(data[12:12 + length])
    points, quads, states = head["points"], head["quads"], len(head["pressures_kPa"])
    check("surface.bin: mark", data[:8] == b"PNLSURF1")
    check("surface.bin: pressures", states == len(samples) and all(
        abs(a - b["pressure_kPa"]) < 1e-3 for a, b in zip(head["pressures_kPa"], samples)))
    plain = zlib.decompress(data[12 + length:])
    check("surface.bin: size", len(plain) == 16 * quads + 2 * points * states * (3 + len(head["fields"])))
    corners, last = [], 0
    for difference in unpack_rows(plain, 1, 4 * quads, 4)[0]:
        last = (last + difference) % 2**32
        corners.append(last)
    check("surface.bin: quads", corners == [c for quad in surface["quads"] for c in quad])
    rows = unpack_rows(plain[16 * quads:], 6 * states, points, 2)
    ranges = list(zip(head["low_mm"], head["high_mm"]))
    ranges += [(field["low"], field["high"]) for field in head["fields"]]
    for channel, (low, high) in enumerate(ranges):
        of = rows[channel * states:(channel + 1) * states]
        for p in range(1, points):
            of[0][p] = (of[0][p] + of[0][p - 1]) % 65536
        for s in range(1, states):
            before = of[s - 2] if s > 1 else of[s - 1]
            of[s] = [(d + 2 * a - b) % 65536 for d, a, b in zip(of[s], of[s - 1], before)]
        if channel > 3:
            continue
        for s, state in ((0, surface["states"][0]), (-1, surface["states"][-1])):
            wanted = [p[channel] for p in state["points_mm"]] if channel < 3 else state["stretch"]
            off = max(abs(low + v * (high - low) / 65535 - w) for v, w in zip(of[s], wanted))
            check("surface.bin: channel %d of state %d" % (channel, s), off < (high - low) / 65535 + 2e-4)


def main(result_path, directory):
    result = json.load(open(result_path))
    artifacts = result["artifacts"]
    check("artifacts are the files, and all of them",
          sorted(artifacts) == sorted(os.listdir(directory)))
    check("artifacts are named once", len(set(artifacts)) == len(artifacts))
    check_samples(result, directory)
    check_midlines(result, directory)
    tip = check_deck(directory)
    check_series(result, directory, "surface", tip)
    check_series(result, directory, "volume", tip)
    surface = json.load(open(os.path.join(directory, "surface.json")))
    check("surface.json", len(surface["states"]) == 2)
    check_recording(directory, surface, result["samples"])
    print("%d files, %d failures" % (len(artifacts), failures))
    return failures != 0


DENSITY = 1080.0  # kg/m3, of the job in test_files.sh
if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
