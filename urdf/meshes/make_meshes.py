#!/usr/bin/env python3
"""Writes the files that shapes.urdf shows: star.stl, bracket.obj, knot.dae, hills.csv. No arguments, no packages.

All three meshes are closed, face outwards and are not convex. The bracket is in millimetres; its faces have more than
three corners.
"""

import math
import pathlib
import struct

HERE = pathlib.Path(__file__).parent


def prism(outline, height):
    """Vertices and faces (polygons) of an outline, anticlockwise, pulled up from z = -height/2 to +height/2."""
    n = len(outline)
    vertices = [(x, y, z) for z in (-height / 2, height / 2) for x, y in outline]
    sides = [(i, (i + 1) % n, n + (i + 1) % n, n + i) for i in range(n)]
    return vertices, [tuple(reversed(range(n))), tuple(range(n, 2 * n)), *sides]


def star(points=5, outer=0.14, inner=0.06, height=0.06):
    """A star, its two caps as fans around a middle: a star is seen from there as a whole."""
    turn = [math.pi * i / points for i in range(2 * points)]
    radii = [outer, inner] * points
    outline = [(r * math.cos(a), r * math.sin(a)) for r, a in zip(radii, turn)]
    vertices, (bottom, top, *sides) = prism(outline, height)
    middles = [len(vertices), len(vertices) + 1]
    vertices += [(0.0, 0.0, -height / 2), (0.0, 0.0, height / 2)]
    fans = [(m, cap[i], cap[(i + 1) % len(cap)]) for m, cap in zip(middles, (bottom, top)) for i in range(len(cap))]
    return vertices, fans + [t for a, b, c, d in sides for t in ((a, b, c), (a, c, d))]


def knot(along=90, around=8, size=0.045, pipe=0.022):
    """A trefoil knot: a pipe along (sin t + 2 sin 2t, cos t - 2 cos 2t, -sin 3t)."""

    def path(t):
        return (math.sin(t) + 2 * math.sin(2 * t), math.cos(t) - 2 * math.cos(2 * t), -math.sin(3 * t))

    def unit(v):
        length = math.sqrt(sum(x * x for x in v))
        return tuple(x / length for x in v)

    def cross(a, b):
        return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])

    vertices, faces = [], []
    for i in range(along):
        t, step = math.tau * i / along, 1e-5
        center, ahead, behind = path(t), path(t + step), path(t - step)
        tangent = unit(tuple(a - b for a, b in zip(ahead, behind)))
        # The vertical is never along the knot: one side of the pipe can follow it.
        side = unit(cross((0.0, 0.0, 1.0), tangent))
        up = cross(tangent, side)
        for j in range(around):
            c, s = math.cos(math.tau * j / around), math.sin(math.tau * j / around)
            vertices.append(tuple(size * p + pipe * (c * x + s * y) for p, x, y in zip(center, side, up)))
            a, b = i * around, (i + 1) % along * around
            k = (j + 1) % around
            faces += [(a + j, a + k, b + k), (a + j, b + k, b + j)]
    return vertices, faces


def write_stl(path, vertices, triangles):
    """Binary STL; normals are left to the reader."""
    records = [struct.pack("<12fH", 0, 0, 0, *(x for i in t for x in vertices[i]), 0) for t in triangles]
    path.write_bytes(b"star".ljust(80) + struct.pack("<I", len(records)) + b"".join(records))


def write_obj(path, vertices, faces):
    lines = ["# an angle bracket, millimetres"]
    lines += ["v " + " ".join(f"{x:g}" for x in v) for v in vertices]
    lines += ["f " + " ".join(str(i + 1) for i in f) for f in faces]
    path.write_text("\n".join(lines) + "\n")


def write_dae(path, vertices, triangles):
    numbers = " ".join(f"{x:.5f}" for v in vertices for x in v)
    indices = " ".join(str(i) for t in triangles for i in t)
    path.write_text(
        f"""<?xml version="1.0" encoding="utf-8"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
  <asset><created>2026-01-01T00:00:00</created><modified>2026-01-01T00:00:00</modified><unit name="meter" meter="1"/><up_axis>Z_UP</up_axis></asset>
  <library_geometries><geometry id="knot"><mesh>
    <source id="corners">
      <float_array id="numbers" count="{3 * len(vertices)}">{numbers}</float_array>
      <technique_common><accessor source="#numbers" count="{len(vertices)}" stride="3">
        <param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/>
      </accessor></technique_common>
    </source>
    <vertices id="vertices"><input semantic="POSITION" source="#corners"/></vertices>
    <triangles count="{len(triangles)}"><input semantic="VERTEX" source="#vertices" offset="0"/><p>{indices}</p></triangles>
  </mesh></geometry></library_geometries>
  <library_visual_scenes><visual_scene id="scene"><node><instance_geometry url="#knot"/></node></visual_scene></library_visual_scenes>
  <scene><instance_visual_scene url="#scene"/></scene>
</COLLADA>
"""
    )


def write_heights(path, columns=13):
    """Two hills and a hollow, values from 0 to 1."""

    def value(x, y):
        return 0.3 + 0.7 * math.exp(-8 * ((x - 0.3) ** 2 + (y - 0.4) ** 2)) - 0.3 * math.exp(-9 * ((x + 0.4) ** 2 + y * y))

    grid = [2 * i / (columns - 1) - 1 for i in range(columns)]
    path.write_text("\n".join(",".join(f"{value(x, -y):.4f}" for x in grid) for y in grid) + "\n")


def main():
    write_stl(HERE / "star.stl", *star())
    bracket = [(-80, -80), (80, -80), (80, -40), (-40, -40), (-40, 80), (-80, 80)]
    write_obj(HERE / "bracket.obj", *prism(bracket, 120))
    write_dae(HERE / "knot.dae", *knot())
    write_heights(HERE / "hills.csv")


if __name__ == "__main__":
    main()
