"""Runs both programs in turns on one core and prints medians over the rounds, and their ratios."""

import json
import os
import statistics
import subprocess
import sys
import tempfile

import pinocchio

ours, theirs, urdf, rounds = sys.argv[1], sys.argv[2], sys.argv[3], int(sys.argv[4])
xml = os.path.join(tempfile.mkdtemp(), "model.xml")
pin_model = pinocchio.buildModelFromUrdf(urdf, pinocchio.JointModelFreeFlyer())
pin_model.saveToXML(xml, "model")
os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})
us, pin = {}, {}
for _ in range(rounds):
    out = json.loads(subprocess.check_output([ours, "bench", urdf, "--base", "free", "--seconds", "0.3", "--json"]))
    for name, row in out["us_per_call"].items():
        us.setdefault(name, []).append(row["median"])
    for name, median in json.loads(subprocess.check_output([theirs, xml, "0.3"])).items():
        pin.setdefault(name, []).append(median)
us = {k: statistics.median(v) for k, v in us.items()}
pin = {k: statistics.median(v) for k, v in pin.items()}
best = min(pin["aba_world"], pin["aba_local"])
print(f"{os.path.basename(urdf)}, {out['nv']} velocities, {rounds} rounds in turns, µs per call (median)")
for name, value in us.items():
    print(f"  realnoid  {name:<18}{value:8.3f}   {value / best:6.3f} of Pinocchio's best aba")
for name, value in pin.items():
    print(f"  pinocchio {name:<18}{value:8.3f}   {value / best:6.3f}")
