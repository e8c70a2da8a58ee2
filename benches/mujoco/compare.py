"""A step of realnoid beside one of MuJoCo: G1, passive, falls from 10 cm onto the spheres of its feet.

Both get the same URDF (every other collision shape taken out), the same start and the same number of steps of 1 ms, in
turns on one core; the figure is thread CPU time per step of the best round.
"""

import json
import os
import subprocess
import sys
import time
import xml.etree.ElementTree as ElementTree

import mujoco

STEP, STEPS, DROP = 1e-3, 600, 0.1


def feet_only(urdf):
    """The robot without anything that does not collide here, as text."""
    robot = ElementTree.parse(urdf).getroot()
    for link in robot.iter("link"):
        for part in link.findall("visual") + [c for c in link.findall("collision") if c.find("geometry/sphere") is None]:
            link.remove(part)
    return ElementTree.tostring(robot, encoding="unicode")


def world(text, time_constant):
    """Only spheres against the ground collide; friction 1, everything else MuJoCo's default but the time constant."""
    spec = mujoco.MjSpec.from_string(text)
    spec.option.timestep = STEP
    spec.option.gravity = [0, 0, -9.80665]
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_EULER
    for geom in spec.geoms:
        geom.contype, geom.conaffinity = 1, 0
    spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_PLANE, size=[0, 0, 1], contype=0, conaffinity=1)
    for geom in spec.geoms:
        geom.friction = [1, 0.005, 0.0001]
        geom.solref = [time_constant, 1]
    for body in spec.worldbody.bodies:
        if not body.joints:
            body.add_freejoint()
    return spec.compile()


def start(model, height):
    data = mujoco.MjData(model)
    data.qpos[2] = height
    return data


def lowest(model):
    """Height of the lowest point with the root at the origin."""
    data = start(model, 0)
    mujoco.mj_forward(model, data)
    spheres = [i for i in range(model.ngeom) if model.geom_type[i] == mujoco.mjtGeom.mjGEOM_SPHERE]
    return min(data.geom_xpos[i][2] - model.geom_size[i][0] for i in spheres)


def fall(model, height):
    """µs per step."""
    data = start(model, height)
    begin = time.thread_time()
    mujoco.mj_step(model, data, STEPS)
    return (time.thread_time() - begin) * 1e6 / STEPS


def penetration(model, height):
    """The deepest, m, and the mean number of contacts."""
    data, deepest, count = start(model, height), 0.0, 0
    for _ in range(STEPS):
        mujoco.mj_step(model, data)
        deepest = max([deepest, *(-c.dist for c in data.contact[: data.ncon])])
        count += data.ncon
    return deepest, count / STEPS


def main():
    ours, urdf, folder, rounds = sys.argv[1], sys.argv[2], sys.argv[3], int(sys.argv[4])
    path = os.path.join(folder, "feet.urdf")
    text = feet_only(urdf)
    with open(path, "w") as file:
        file.write(text)
    os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})
    models = {f"MuJoCo {mujoco.__version__}, solref {t}": world(text, t) for t in (0.02, 0.004)}
    height = float(DROP - lowest(next(iter(models.values()))))
    command = [ours, "bench", path, "--drop", repr(height), "--steps", str(STEPS), "--rounds", "3", "--json"]
    best, about = {}, {name: penetration(model, height) for name, model in models.items()}
    for _ in range(rounds):
        out = json.loads(subprocess.check_output(command))
        for name, row in out["drop"].items():
            best[f"realnoid, {name}"] = min(best.get(f"realnoid, {name}", 1e9), row["us_per_step"])
            about[f"realnoid, {name}"] = row["worst_penetration"], row["contacts"]
        for name, model in models.items():
            best[name] = min([best.get(name, 1e9), *(fall(model, height) for _ in range(3))])
    nv = {model.nv for model in models.values()} | {out["nv"]}
    assert len(nv) == 1, f"not the same tree: {nv}"
    print(f"{os.path.basename(urdf)}, {nv.pop()} velocities, {STEPS} steps of {STEP} s, best of {3 * rounds} falls\n")
    base = best[next(iter(models))]
    print("| | µs per step | of MuJoCo | deepest penetration, mm | contacts, mean |\n|---|---|---|---|---|")
    for name, us in best.items():
        deepest, count = about[name]
        print(f"| {name} | {us:.1f} | {us / base:.2f} | {1e3 * deepest:.3f} | {count:.1f} |")


if __name__ == "__main__":
    main()
