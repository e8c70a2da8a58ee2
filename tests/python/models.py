"""Where the public humanoids are that the test environment installs from PyPI."""

import pathlib
import sys

SITE = pathlib.Path(sys.prefix)


def _find(name):
    found = sorted(SITE.rglob(name))
    if not found:
        raise FileNotFoundError(f"{name} is not under {SITE}: is requirements.txt installed?")
    return found[0]


def public_models():
    """Name -> URDF path of G1, simple_humanoid and JVRC-1."""
    return {
        "g1": _find("g1_29dof_rev_1_0.urdf"),
        "simple_humanoid": _find("simple_humanoid.urdf"),
        "jvrc1": _find("jvrc1.urdf"),
    }
