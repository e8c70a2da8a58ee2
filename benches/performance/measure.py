"""Measures every speed of issue 8 beside its peer, in turns on one core, and prints ratios and raw figures as Markdown.

A figure is thread CPU time: the median over the rounds of the medians that a program reports of itself; for falls, the best.
"""

import argparse
import json
import os
import platform
import statistics
import subprocess
import sys
import tempfile
import time

ROOT = sys.argv[1]
sys.path.insert(0, os.path.join(ROOT, "benches", "mujoco"))

import compare  # noqa: E402
import mujoco  # noqa: E402
import page  # noqa: E402

OURS = os.path.join(ROOT, "target", "release", "realnoid")
PINOCCHIO = os.path.join(ROOT, "target", "pinocchio")
SECONDS = "0.2"
# As `realnoid bench` does: so many steps of 1 ms, then from the start again.
STEPS, TURNS = 64, 20
LINKS = 200


def run(*command):
    return json.loads(subprocess.check_output(command))


def find(name):
    for folder, _, files in os.walk(os.path.join(PINOCCHIO, "venv")):
        if name in files:
            return os.path.join(folder, name)
    sys.exit(f"{name} is not in the wheels: remove {PINOCCHIO} and start again")


def chain(path):
    """Hinges in a row, every axis turned by 30° about the link against the one before: 1 kg and 0.2 m each."""
    parts = ['<robot name="chain"><link name="l0"/>']
    for k in range(1, LINKS + 1):
        parts.append(
            f'<link name="l{k}"><inertial><origin xyz="0.1 0 0"/><mass value="1"/>'
            '<inertia ixx="0.0004" iyy="0.0035" izz="0.0035" ixy="0" ixz="0" iyz="0"/></inertial></link>'
            f'<joint name="j{k}" type="continuous"><parent link="l{k - 1}"/><child link="l{k}"/>'
            f'<origin xyz="{0.2 if k > 1 else 0} 0 0" rpy="{0.5235987755982988 if k % 2 else -0.5235987755982988} 0 0"/><axis xyz="0 0 1"/></joint>'
        )
    with open(path, "w") as file:
        file.write("".join(parts) + "</robot>")


def to_xml(urdf, xml, floating):
    """Pinocchio's own format, which its C++ half reads."""
    root = ", pinocchio.JointModelFreeFlyer()" if floating else ""
    code = f"import pinocchio; pinocchio.buildModelFromUrdf({urdf!r}{root}).saveToXML({xml!r}, 'model')"
    subprocess.check_call([os.path.join(PINOCCHIO, "venv", "bin", "python"), "-c", code])


class Figures:
    """All readings, by name."""

    def __init__(self):
        self.readings = {}

    def add(self, group, rows):
        for name, value in rows.items():
            self.readings.setdefault((group, name), []).append(value)

    def median(self, group, name):
        return statistics.median(self.readings[group, name]) if (group, name) in self.readings else None

    def least(self, group, name):
        return min(self.readings[group, name])


def medians(urdf, base):
    rows = run(OURS, "bench", urdf, "--base", base, "--seconds", SECONDS, "--json")["us_per_call"]
    return {name: row["median"] for name, row in rows.items()}


def in_the_air(urdf, integrator):
    """A model of the same tree in which nothing collides."""
    model = compare.world(compare.feet_only(urdf), 0.02)
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT
    model.opt.integrator = integrator
    return model


def steps(model):
    """µs per step from the start, medians of runs."""
    times, data = [], mujoco.MjData(model)
    for _ in range(TURNS):
        begin = time.thread_time()
        mujoco.mj_resetData(model, data)
        mujoco.mj_step(model, data, STEPS)
        times.append((time.thread_time() - begin) * 1e6 / STEPS)
    return {"mj_step": statistics.median(times)}


def chain5():
    """Curves of a chain of five links over steps and tolerances, ours and MuJoCo's; nothing if the command cannot do it."""
    command = [OURS, "accuracy", "chain5", "--engines", "rbx", "--peer", "mujoco", "--json"]
    done = subprocess.run(command, capture_output=True, text=True, cwd=ROOT)
    if done.returncode != 0:
        print(f"{' '.join(command[1:])}: {done.stderr.strip()}", file=sys.stderr)
        return []
    out = json.loads(done.stdout)
    cases = out["cases"] if isinstance(out, dict) else out
    return cases[0]["curves"]


def falls(figures, feet, models, height):
    command = [OURS, "bench", feet, "--drop", repr(height), "--steps", str(compare.STEPS), "--rounds", "3", "--json"]
    for name, row in run(*command)["drop"].items():
        figures.add("fall", {name: row["us_per_step"]})
        figures.add("depth", {name: row["worst_penetration"]})
        figures.add("contacts", {name: row["contacts"]})
    for name, model in models.items():
        figures.add("fall", {name: min(compare.fall(model, height) for _ in range(3))})


def measure(rounds):
    figures, folder = Figures(), tempfile.mkdtemp()
    at = lambda name: os.path.join(folder, name)  # noqa: E731
    g1, chain200 = find("g1_29dof_rev_1_0.urdf"), at("chain200.urdf")
    chain(chain200)
    to_xml(g1, at("g1.xml"), True)
    to_xml(chain200, at("chain200.xml"), False)
    with open(at("feet.urdf"), "w") as file:
        file.write(compare.feet_only(g1))
    kinds = mujoco.mjtIntegrator
    free = {name: in_the_air(g1, kind) for name, kind in (("Euler", kinds.mjINT_EULER), ("implicitfast", kinds.mjINT_IMPLICITFAST), ("RK4", kinds.mjINT_RK4))}
    landing = {f"solref {t}": compare.world(compare.feet_only(g1), t) for t in (0.02, 0.004)}
    height = float(compare.DROP - compare.lowest(landing["solref 0.02"]))
    for name, model in landing.items():
        depth, contacts = compare.penetration(model, height)
        figures.add("depth", {name: depth})
        figures.add("contacts", {name: contacts})
    aba = os.path.join(PINOCCHIO, "aba")
    for _ in range(rounds):
        figures.add("g1", medians(g1, "free"))
        figures.add("pinocchio g1", run(aba, at("g1.xml"), SECONDS))
        figures.add("chain200", medians(chain200, "fixed"))
        figures.add("pinocchio chain200", run(aba, at("chain200.xml"), SECONDS))
        for name, model in free.items():
            figures.add(f"mujoco {name}", steps(model))
        falls(figures, at("feet.urdf"), landing, height)
    return figures


def machine():
    with open("/proc/cpuinfo") as file:
        lines = (line.split(":", 1)[1].strip() for line in file if line.startswith("model name"))
        name = next(lines, platform.machine())
    commit = subprocess.check_output(["git", "-C", ROOT, "rev-parse", "--short=12", "HEAD"], text=True).strip()
    return f"{name}, {os.cpu_count()} cores, {platform.system()}; {time.strftime('%Y-%m-%d', time.gmtime())}; commit {commit}"


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("root")
    parser.add_argument("--write", action="store_true")
    parser.add_argument("--no-build", action="store_true")
    parser.add_argument("--rounds", type=int, default=5)
    args = parser.parse_args()
    os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})
    text = page.page(measure(args.rounds), chain5(), (machine(), mujoco.__version__, args.rounds))
    print(text)
    if args.write:
        with open(os.path.join(ROOT, "docs", "performance.md"), "w") as file:
            file.write(text)


main()
