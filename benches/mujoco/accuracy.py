"""MuJoCo's half of `realnoid accuracy --peer mujoco`: the same bodies from the same start with each of its integrators.

Reads a JSON file (cases with MJCF text, start, what is looked at; steps; CPU time to spend), writes JSON to standard output. realnoid runs it
and computes the errors of the samples by the same rule as its own. CPU time is that of the thread in mj_step, the fastest of several runs.
"""

import json
import sys
import time

import mujoco
import numpy

GRID = 0.04
INTEGRATORS = {
    "Euler": mujoco.mjtIntegrator.mjINT_EULER,
    "implicitfast": mujoco.mjtIntegrator.mjINT_IMPLICITFAST,
    "RK4": mujoco.mjtIntegrator.mjINT_RK4,
}
REPEATS, ONCE = 50, 1.0


def start(model, case):
    data = mujoco.MjData(model)
    data.qpos[:], data.qvel[:] = case["qpos"], case["qvel"]
    return data


def sample(model, data, looks):
    """One number after the other: points in the world, and quaternions x, y, z, w."""
    mujoco.mj_kinematics(model, data)
    out = []
    for look in looks:
        body = data.body(look["body"])
        if "point" in look:
            out.extend(body.xpos + body.xmat.reshape(3, 3) @ numpy.array(look["point"]))
        else:
            out.extend(body.xquat[[1, 2, 3, 0]])
    # JSON has no word for what is not finite.
    return [float(x) if numpy.isfinite(x) else None for x in out]


def run(model, case, step, seconds):
    model.opt.timestep = step
    chunk = round(GRID / step)
    data, values = start(model, case), []
    for _ in range(case["instants"]):
        mujoco.mj_step(model, data, chunk)
        values.append(sample(model, data, case["looks"]))
    # It begins anew at once when a value is not finite or huge, and warns of that alone.
    failed = any(data.warning[w].number for w in (mujoco.mjtWarning.mjWARN_BADQPOS, mujoco.mjtWarning.mjWARN_BADQVEL, mujoco.mjtWarning.mjWARN_BADQACC))
    best, spent, repeats = float("inf"), 0.0, 0
    while repeats == 0 or (spent < seconds and best < ONCE and repeats < REPEATS):
        data = start(model, case)
        begin = time.thread_time()
        mujoco.mj_step(model, data, chunk * case["instants"])
        took = time.thread_time() - begin
        best, spent, repeats = min(best, took), spent + took, repeats + 1
    return {"step": step, "cpu": best, "failed": failed, "values": values}


def main():
    with open(sys.argv[1], encoding="utf-8") as file:
        request = json.load(file)
    out = {"version": mujoco.__version__, "cases": []}
    for case in request["cases"]:
        try:
            model, curves = mujoco.MjModel.from_xml_string(case["mjcf"]), []
        except ValueError as reason:
            out["cases"].append({"name": case["name"], "curves": [], "refused": str(reason)})
            continue
        for name, integrator in INTEGRATORS.items():
            model.opt.integrator = integrator
            runs = [run(model, case, step, request["seconds"]) for step in request["steps"]]
            curves.append({"integrator": name, "runs": runs})
        out["cases"].append({"name": case["name"], "curves": curves})
    json.dump(out, sys.stdout)


main()
