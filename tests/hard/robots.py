#!/usr/bin/env python3
"""Writes the chains of this folder: tests/hard/robots.py. What is short is written by hand."""

from pathlib import Path

HERE = Path(__file__).parent


def link(name, mass, length, inertia=None):
    thin = mass * length**2 / 12
    along, across = inertia or (thin / 50, thin)
    return (
        f'  <link name="{name}"><inertial><origin xyz="{length / 2:g} 0 0"/><mass value="{mass:g}"/>'
        f'<inertia ixx="{along:.6g}" ixy="0" ixz="0" iyy="{across:.6g}" iyz="0" izz="{across:.6g}"/></inertial></link>\n'
    )


def joint(i, length, kind="continuous", more=""):
    parent = "base" if i == 1 else f"link{i - 1}"
    at = 0 if i == 1 else length
    axis = "0 1 0" if i % 2 else "0 0 1"
    return (
        f'  <joint name="hinge{i}" type="{kind}"><parent link="{parent}"/><child link="link{i}"/>'
        f'<origin xyz="{at:g} 0 0"/><axis xyz="{axis}"/>{more}</joint>\n'
    )


def chain(file, about, masses, length, more=("continuous", ""), last=""):
    text = f'<?xml version="1.0"?>\n<!-- {about} Made by robots.py. -->\n<robot name="{file}">\n  <link name="base"/>\n'
    for i, mass in enumerate(masses, 1):
        text += (last if last and i == len(masses) else link(f"link{i}", mass, length)) + joint(i, length, *more)
    (HERE / f"{file}.urdf").write_text(text + "</robot>\n")


STOPS = ("revolute", '<limit lower="-0.1" upper="0.1" effort="100" velocity="100"/>')
STIFF = (
    "revolute",
    '<limit lower="-3" upper="3" effort="200" velocity="20"/><realnoid><drive mode="servo" bandwidth="{0}"/></realnoid>',
)
chain("chain100", "A hundred hinges, alternately about y and z; each link 1 kg, 0.2 m.", [1] * 100, 0.2)
chain("whip", "Ten hinges; each link 0.2 m and a tenth of the mass of the one before: 1 kg … 1e-9 kg.", [10.0**-i for i in range(10)], 0.2)
ball = '  <link name="link10"><inertial><origin xyz="0.1 0 0"/><mass value="100"/><inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial></link>\n'
chain("wrecking_ball", "Ten hinges, links of 0.1 kg and 0.1 m, and 100 kg at the end.", [0.1] * 10, 0.1, last=ball)
chain("rattle", "Eight hinges with stops at 0.1 rad; each link 1 kg, 0.2 m.", [1] * 8, 0.2, STOPS)
for hz in (100, 500, 1000):
    chain(f"servo{hz}", f"Three hinges with servos of {hz} Hz; each link 1 kg, 0.2 m.", [1] * 3, 0.2, (STIFF[0], STIFF[1].format(hz)))
