#!/usr/bin/env python3
"""Draws the default humanoid from its <visual>s, front and side, as SVG: draw_humanoid.py [FILE.urdf] > humanoid.svg

Needs only Python. Each shape is drawn as the outline of its projection, the nearest last.
"""

import math
import sys
import xml.etree.ElementTree as ET
from pathlib import Path

PIXELS_PER_METRE = 380
MARGIN = 0.16
CORNERS = 40
GROUND, TEXT = "#8a94a0", "#66717d"
# Direction towards the viewer, right and up on the paper, in the frame of the robot (REP-103).
VIEWS = {"front": ((1, 0, 0), (0, 1, 0), (0, 0, 1)), "left side": ((0, 1, 0), (-1, 0, 0), (0, 0, 1))}


def numbers(text, default):
    return [float(x) for x in text.split()] if text else default


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def compose(parent, child):
    """(rotation rows, position) of a child frame in the frame of the parent's parent."""
    (r, p), (s, q) = parent, child
    rotation = [[dot(row, column) for column in zip(*s)] for row in r]
    return rotation, [dot(row, q) + x for row, x in zip(r, p)]


def apply(frame, point):
    return [dot(row, point) + x for row, x in zip(*frame)]


def origin(element):
    """Frame of an <origin>; URDF turns about the fixed X, then Y, then Z."""
    tag = element.find("origin")
    xyz = numbers(tag.get("xyz"), [0, 0, 0]) if tag is not None else [0, 0, 0]
    roll, pitch, yaw = numbers(tag.get("rpy"), [0, 0, 0]) if tag is not None else (0, 0, 0)
    (sr, cr), (sp, cp), (sy, cy) = ((math.sin(a), math.cos(a)) for a in (roll, pitch, yaw))
    rotation = [
        [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
        [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
        [-sp, cp * sr, cp * cr],
    ]
    return rotation, xyz


def points(geometry):
    """Points whose convex hull is the shape."""
    shape = geometry[0]
    circle = [(math.cos(2 * math.pi * k / CORNERS), math.sin(2 * math.pi * k / CORNERS)) for k in range(CORNERS)]
    if shape.tag == "box":
        x, y, z = (s / 2 for s in numbers(shape.get("size"), None))
        return [(a * x, b * y, c * z) for a in (-1, 1) for b in (-1, 1) for c in (-1, 1)]
    radius = float(shape.get("radius"))
    if shape.tag == "cylinder":
        half = float(shape.get("length")) / 2
        return [(radius * c, radius * s, z) for c, s in circle for z in (-half, half)]
    if shape.tag == "sphere":
        rings = [math.pi * (k + 0.5) / CORNERS for k in range(CORNERS)]
        return [(radius * math.sin(t) * c, radius * math.sin(t) * s, radius * math.cos(t)) for c, s in circle for t in rings]
    raise SystemExit(f"cannot draw <{shape.tag}>")


def hull(flat):
    """Convex hull of points in the plane, counter-clockwise."""
    flat = sorted(set(flat))

    def half(sequence):
        chain = []
        for p in sequence:
            while len(chain) > 1:
                (ax, ay), (bx, by) = chain[-2:]
                if (bx - ax) * (p[1] - ay) > (by - ay) * (p[0] - ax):
                    break
                chain.pop()
            chain.append(p)
        return chain[:-1]

    return half(flat) + half(reversed(flat))


def frames(robot):
    """Frame of every link, all angles at 0."""
    joints = {j.find("child").get("link"): j for j in robot.findall("joint")}

    def frame(link):
        joint = joints.get(link)
        if joint is None:
            return [[1, 0, 0], [0, 1, 0], [0, 0, 1]], [0, 0, 0]
        return compose(frame(joint.find("parent").get("link")), origin(joint))

    return {link.get("name"): frame(link.get("name")) for link in robot.findall("link")}


def visuals(robot):
    """(points in the frame of the root, colour) of every visual."""
    colours = {m.get("name"): numbers(m.find("color").get("rgba"), None)[:3] for m in robot.findall("material")}
    at = frames(robot)
    for link in robot.findall("link"):
        for visual in link.findall("visual"):
            frame = compose(at[link.get("name")], origin(visual))
            material = visual.find("material")
            colour = colours.get(material.get("name") if material is not None else None, [0.7, 0.7, 0.7])
            yield [apply(frame, p) for p in points(visual.find("geometry"))], colour


def fill(colour):
    return "#" + "".join(f"{round(255 * c):02x}" for c in colour)


def area(polygon):
    twice = sum(ax * by - bx * ay for (ax, ay), (bx, by) in zip(polygon, polygon[1:] + polygon[:1]))
    return round(twice / 2, 6)


def outlines(shapes, view, left):
    """SVG of one view; `left` is the x of its middle line, px."""
    towards, right, up = view
    projected = []
    for cloud, colour in shapes:
        flat = hull([(round(dot(right, p), 5), round(dot(up, p), 5)) for p in cloud])
        reach = round(max(dot(towards, p) for p in cloud), 5)
        projected.append((reach, area(flat), flat, colour))
    # What reaches furthest towards the viewer hides what reaches less far; of two that reach as far, the larger one hides.
    for _, _, flat, colour in sorted(projected):
        path = " ".join(f"{left + PIXELS_PER_METRE * x:.1f},{-PIXELS_PER_METRE * y:.1f}" for x, y in flat)
        yield f'<polygon points="{path}" fill="{fill(colour)}"/>'


def draw(robot):
    shapes = list(visuals(robot))
    everything = [p for cloud, _ in shapes for p in cloud]
    low, high = min(p[2] for p in everything), max(p[2] for p in everything)
    reach = max(abs(p[1]) for p in everything) + MARGIN
    middles = [reach * PIXELS_PER_METRE, 2.6 * reach * PIXELS_PER_METRE]
    width, top = 3.5 * reach * PIXELS_PER_METRE, -(high + MARGIN / 2) * PIXELS_PER_METRE
    ground = -low * PIXELS_PER_METRE
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 {top:.0f} {width:.0f} {ground - top + 34:.0f}" '
        f'font-family="sans-serif" font-size="13" fill="{TEXT}">',
        f"<title>{robot.get('name')}: front and left side, drawn by draw_humanoid.py</title>",
    ]
    for (name, view), middle in zip(VIEWS.items(), middles):
        parts += ['<g stroke="#6b7683" stroke-width="0.8" stroke-linejoin="round">', *outlines(shapes, view, middle), "</g>"]
        parts.append(f'<text x="{middle:.0f}" y="{ground + 24:.0f}" text-anchor="middle">{name}</text>')
    x, head = width - 40, -high * PIXELS_PER_METRE
    parts += [
        f'<path d="M10 {ground:.1f}H{width - 10:.0f}" stroke="{GROUND}"/>',
        f'<path d="M{x} {head:.1f}V{ground:.1f}M{x - 5} {head:.1f}h10" stroke="{GROUND}" fill="none"/>',
        f'<text x="{x + 6}" y="{(head + ground) / 2:.0f}" transform="rotate(-90 {x + 6} {(head + ground) / 2:.0f})" '
        f'text-anchor="middle" dy="12">{high - low:.2f} m</text>',
        "</svg>",
    ]
    return "\n".join(parts)


if __name__ == "__main__":
    default = Path(__file__).parents[2] / "urdf/origin.urdf"
    print(draw(ET.parse(sys.argv[1] if len(sys.argv) > 1 else default).getroot()))
