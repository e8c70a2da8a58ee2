"""Closed meshes that are made here: most are not convex."""

import numpy
import trimesh


def grid(place, rows, columns):
    """Triangles over a grid of places that closes along its rows and along its columns."""
    vertices = numpy.array([[place(i, j) for j in range(columns)] for i in range(rows)], dtype=float).reshape(-1, 3)
    at = lambda i, j: (i % rows) * columns + j % columns
    cells = [(i, j) for i in range(rows) for j in range(columns)]
    quads = [(at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)) for i, j in cells]
    faces = [face for a, b, c, d in quads for face in ((a, b, c), (a, c, d))]
    return trimesh.Trimesh(vertices, faces, process=False)


def knotted_tube():
    """A pipe along a trefoil."""

    def place(i, j):
        t, s = 2 * numpy.pi * i / 120, 2 * numpy.pi * j / 16
        line = lambda t: numpy.array([numpy.sin(t) + 2 * numpy.sin(2 * t), numpy.cos(t) - 2 * numpy.cos(2 * t), -numpy.sin(3 * t)])
        along = line(t + 1e-4) - line(t - 1e-4)
        side = numpy.cross(along, [0.3, 0.2, 1.0])
        up = numpy.cross(side, along)
        unit = lambda v: v / numpy.linalg.norm(v)
        return line(t) + 0.3 * (numpy.cos(s) * unit(side) + numpy.sin(s) * unit(up))

    mesh = grid(place, 120, 16)
    return mesh if mesh.volume > 0 else mesh.invert() or mesh


def prism(outline, triangles, height=0.3):
    """An outline, anticlockwise, with its triangulation, raised."""
    return trimesh.creation.extrude_triangulation(numpy.array(outline, dtype=float), numpy.array(triangles), height)


def star_prism():
    angles = numpy.arange(10) * numpy.pi / 5
    radii = numpy.where(numpy.arange(10) % 2 == 0, 1.0, 0.3)
    outline = [(0.0, 0.0), *zip(radii * numpy.cos(angles), radii * numpy.sin(angles))]
    return prism(outline, [(0, i + 1, (i + 1) % 10 + 1) for i in range(10)])


def l_prism():
    return prism([(0, 0), (2, 0), (2, 1), (1, 1), (1, 3), (0, 3)], [(0, 1, 2), (0, 2, 3), (0, 3, 4), (0, 4, 5)])


def with_cavity():
    hole = trimesh.creation.icosphere(subdivisions=3, radius=0.2).apply_translation([0.1, 0.05, -0.1])
    hole.invert()
    return trimesh.util.concatenate([trimesh.creation.box(extents=[1, 0.8, 0.9]), hole])


def two_parts():
    far = trimesh.creation.cylinder(radius=0.2, height=1.5, sections=40).apply_translation([2, 1, 0])
    return trimesh.util.concatenate([trimesh.creation.capsule(height=0.5, radius=0.3), far])


MADE = {
    "torus": lambda: trimesh.creation.torus(0.4, 0.1, major_sections=64, minor_sections=32),
    "annulus": lambda: trimesh.creation.annulus(0.1, 0.25, 0.3, sections=48),
    "l_prism": l_prism,
    "star_prism": star_prism,
    "cavity": with_cavity,
    "two_parts": two_parts,
    "knot": knotted_tube,
    "icosphere": lambda: trimesh.creation.icosphere(subdivisions=4, radius=0.35),
    "far_away": lambda: trimesh.creation.torus(0.1, 0.03).apply_translation([3.0, -2.0, 5.0]),
    "needle": lambda: trimesh.creation.cone(radius=0.001, height=1.0, sections=24),
}
