"""Instructions per step of the scenes beside this file, counted by `realnoid effects`, against counts.json.

counts.json is keyed by compiler and features, because the instructions depend on both: rustc -> features -> scene -> count."""

import argparse
import json
import os
import pathlib
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor

HERE = pathlib.Path(__file__).parent
FILE = HERE / "counts.json"
STEPS = 40
# A step of these is so long that callgrind would take minutes.
FEWER_STEPS = {"ground": 2}
GROWTH = 0.01
# How memcpy copies depends on the address: a few instructions per step between two worlds that do the same. Where bodies touch, buffers grow in
# the first steps, and what the allocator does for that depends on what was there before.
BY_ADDRESS = 16
# The C library picks its memcpy by what the processor can do; this one they all can.
SAME_EVERYWHERE = "glibc.cpu.hwcaps=-AVX2_Usable,-AVX2,-AVX512F,-AVX512VL,-ERMS,-FSRM,-AVX_Fast_Unaligned_Load,-Prefer_ERMS,-Prefer_FSRM"


def price_list(binary, scene):
    """What `realnoid effects` says of a scene."""
    command = [binary, "effects", "--scene", scene, "--steps", str(FEWER_STEPS.get(scene.stem, STEPS)), "--rounds", "1", "--seconds", "0.001", "--json"]
    tunables = os.environ.get("GLIBC_TUNABLES", SAME_EVERYWHERE)
    done = subprocess.run(command, env={**os.environ, "GLIBC_TUNABLES": tunables}, capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"{scene.name}: {done.stderr}")
    said = json.loads(done.stdout)
    if said["uncounted"]:
        sys.exit(f"{scene.name}: {said['uncounted']}")
    return said


def wasted(prices):
    """Effects that nothing calls for, with what they cost all the same."""
    touches = any(e["name"] == "contact" and e["on"] for e in prices["effects"])
    least = GROWTH * prices["instructions_per_step"] if touches else BY_ADDRESS
    idle = (e for e in prices["effects"] if e["kind"] == "switched" and not e["called_for"])
    return {e["name"]: e["instructions_per_step"] for e in idle if abs(e["instructions_per_step"]) > least}


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("binary")
    parser.add_argument("--write", action="store_true", help="write counts.json anew")
    arguments = parser.parse_args()
    rustc = subprocess.check_output(["rustc", "-V"], text=True, cwd=HERE).strip()
    engines = json.loads(subprocess.check_output([arguments.binary, "engines", "--json"], text=True))["engines"]
    features = " ".join(e["name"] for e in engines if e["built"])
    scenes = sorted(HERE.glob("*.yaml"))
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        lists = dict(zip(scenes, pool.map(lambda scene: price_list(arguments.binary, scene), scenes)))
    counts = {scene.stem: round(prices["instructions_per_step"]) for scene, prices in lists.items()}
    kept = json.loads(FILE.read_text()) if FILE.exists() else {}
    known = kept.get(rustc, {}).get(features)
    faults = [f"{scene.stem}: '{name}' is not called for and costs {cost} instructions per step"
              for scene, prices in lists.items() for name, cost in wasted(prices).items()]
    for name, count in counts.items():
        before = (known or {}).get(name)
        change = f"{100 * (count / before - 1):+.2f} %" if before else "not known yet"
        print(f"{name:<10} {count:>9} instructions per step  {change}")
        if before and count > before * (1 + GROWTH) and not arguments.write:
            faults.append(f"{name}: {count} instructions per step, {before} before ({change}); if that is meant, benches/counts/run --write")
        if known is not None and before is None and not arguments.write:
            faults.append(f"{name}: not in counts.json; benches/counts/run --write")
    if known is None and not arguments.write:
        print(f"counts.json has none for {rustc} with {features}: only told, not compared; benches/counts/run --write adds them")
    if arguments.write:
        kept.setdefault(rustc, {})[features] = counts
        FILE.write_text(json.dumps(kept, indent=2, sort_keys=True) + "\n")
    sys.exit("\n".join(faults) or 0)


if __name__ == "__main__":
    main()
