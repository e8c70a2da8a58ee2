"""docs/performance.md: goals, what was reached, raw figures. Reasons are typed, figures never are."""

# What stands in the way where a goal is missed, by the key of its row.
REASONS = {
    "exact": "one body after the other in plain scalar code without fusing, whose operations alone take most of this time. `aba_limbs` has the same bits and is what "
    "steps use where it pays.",
    "fused": "the kernel waits for its own results from body to body. `aba_limbs` has the bits of `aba` and is faster.",
    "limbs": "the time is that of the longest limb: bodies behind each other cannot be computed together.",
    "lanes4": "the lanes are full; what is left is the spilling of values that do not fit into the registers.",
    "lanes8": "the lanes are full; what is left is spilling and the cache.",
    "turns4": "the pass itself is as above; the rest is copying everything in and out, and the turns.",
    "turns8": "the pass itself is as above; the rest is copying everything in and out, and the turns.",
    "chain": "bodies in a row cannot be computed side by side, and the working set of so many is larger than the first cache.",
    "chain_fused": "bodies in a row cannot be computed side by side, and the working set of so many is larger than the first cache.",
    "air": "the pass of the dynamics is the smaller part; poses of all links, the laws of all axes with their stops, and the check whether every axis fits its law are the rest.",
    "ground": "no part dominates: the rows of the contacts, their sweeps and their direct finish (an exact, round cone; MuJoCo stops at a soft pyramid), the pass of the "
    "dynamics, the poses and the laws of the axes share it.",
    "depth": "see the raw figures.",
    "chain5": "at the finest steps our own error is rounding, grown by two chaotic seconds; see the table at the end and docs/accuracy.md.",
}


def best_of(figures, group):
    values = [figures.median(group, name) for name in ("aba_world", "aba_local")]
    return min(values)


def goals(f):
    """Key, what, goal, ours, theirs, names of both."""
    pin, chain = best_of(f, "pinocchio g1"), best_of(f, "pinocchio chain200")
    g1 = lambda name: f.median("g1", name)  # noqa: E731
    rows = [
        ("exact", "ABA of G1, one robot, same bits on every machine (`aba`)", 0.35, g1("aba"), pin, "Pinocchio's `aba`"),
        ("fused", "the same with fused multiply-add (`aba_fused`)", 0.30, g1("aba_fused"), pin, "Pinocchio's `aba`"),
        ("limbs", "its limbs side by side (`aba_limbs`), the bits of `aba`", 0.20, g1("aba_limbs"), pin, "Pinocchio's `aba`"),
        ("lanes4", "4 robots side by side (AVX2), each, the bits of `aba`", 0.10, g1("aba_lanes_4"), pin, "Pinocchio's `aba`"),
        ("lanes8", "8 robots side by side (AVX-512), each, the bits of `aba`", 0.06, g1("aba_lanes_8"), pin, "Pinocchio's `aba`"),
        ("turns4", "4 worlds of a sweep in one pass (AVX2), each, with all copying and turns (`aba_turns_4`)", 0.10, g1("aba_turns_4"), pin, "Pinocchio's `aba`"),
        ("turns8", "8 worlds of a sweep in one pass (AVX-512), each, with all copying and turns (`aba_turns_8`)", 0.06, g1("aba_turns_8"), pin, "Pinocchio's `aba`"),
        ("chain", "ABA of a chain of 200 hinges, same bits on every machine (`aba`)", 0.36, f.median("chain200", "aba"), chain, "Pinocchio's `aba`"),
        ("chain_fused", "the same with fused multiply-add (`aba_fused`)", 0.36, f.median("chain200", "aba_fused"), chain, "Pinocchio's `aba`"),
    ]
    step = min(("step_implicit_midpoint", "step_semi_implicit_euler"), key=g1)
    rows.append(("air", f"step of G1 in the air (`{step}`)", 0.5, g1(step), f.median("mujoco Euler", "mj_step"), "MuJoCo's `mj_step`, Euler"))
    fall = min(("semi_implicit_euler", "implicit_midpoint"), key=lambda name: f.least("fall", name))
    rows.append(("ground", f"step of G1 falling onto the 8 spheres of its feet (`{fall}`)", 0.7, f.least("fall", fall), f.least("fall", "solref 0.02"), "`mj_step`, Euler"))
    return [row for row in rows if row[3] is not None]


def equal_time(curves):
    """Per run of MuJoCo's RK4: its step, its time, its error, and the least error that ours has in no more time."""
    error = lambda run: run["at_end"]  # noqa: E731
    ours, theirs = [], []
    for curve in curves:
        runs = [run for run in curve["runs"] if not run["diverged"] and error(run)]
        if "mujoco" not in curve["engine"].lower():
            ours += [(run["cpu_per_second"], error(run), curve["integrator"]) for run in runs]
        elif curve["integrator"].lower().endswith("rk4"):
            theirs += [(run["dt"], run["cpu_per_second"], error(run)) for run in runs]
    out = []
    for dt, cpu, wrong in theirs:
        within = [run for run in ours if run[0] <= cpu]
        if within:
            out.append((dt, cpu, wrong, *min(within, key=lambda run: run[1])))
    return out


def summary(rows, deepest, equal):
    lines = ["| | goal | reached | ours, µs | theirs, µs | whose | |", "|---|---|---|---|---|---|---|"]
    missed = []
    for key, what, goal, ours, theirs, whose in rows:
        met = ours / theirs <= goal
        missed += [] if met else [key]
        lines.append(f"| {what} | {goal:.2f} | {ours / theirs:.3f} | {ours:.3f} | {theirs:.3f} | {whose} | {'reached' if met else '**missed**'} |")
    own, other = deepest
    missed += [] if own <= 0.1 * other else ["depth"]
    word = "reached" if own <= 0.1 * other else "**missed**"
    lines.append(f"| deepest penetration in that fall | 0.10 | {own / other:.1e} | {1e3 * own:.1e} mm | {1e3 * other:.1e} mm | MuJoCo, default softness | {word} |")
    if equal:
        worst = max(equal, key=lambda row: row[4] / row[2])
        met = worst[4] / worst[2] <= 1e-3
        missed += [] if met else ["chain5"]
        word = "reached" if met else "**missed**"
        lines.append(
            f"| error of a chain of five links at 2 s at equal CPU time, worst of the steps below | 1e-3 | {worst[4] / worst[2]:.1e} | "
            f"{worst[4]:.1e} m | {worst[2]:.1e} m | MuJoCo's RK4 at {worst[0]} s | {word} |"
        )
    return lines, missed


def raw(f, rounds):
    lines = [f"## Raw figures\n\nµs per call, thread CPU time: median of {rounds} rounds in turns; per robot where robots are side by side.\n"]
    for group, title in (("g1", "G1, free base"), ("chain200", "chain of 200 hinges, fixed base")):
        best = best_of(f, f"pinocchio {group}")
        lines += [f"**{title}**\n", "| | µs | of Pinocchio's better `aba` |", "|---|---|---|"]
        for owner in (group, f"pinocchio {group}"):
            for name in [name for g, name in f.readings if g == owner]:
                value = f.median(owner, name)
                lines.append(f"| {'Pinocchio ' if owner != group else ''}`{name}` | {value:.3f} | {value / best:.3f} |")
        lines.append("")
    lines += ["**Step of G1 in the air, 1 ms**\n", "| | µs |", "|---|---|"]
    lines += [f"| MuJoCo {name} | {f.median('mujoco ' + name, 'mj_step'):.3f} |" for name in ("Euler", "implicitfast", "RK4")]
    lines += [f"| realnoid `{name}` | {f.median('g1', name):.3f} |" for g, name in f.readings if g == "g1" and name.startswith("step")]
    lines += ["", "**G1 falls from 10 cm, 600 steps of 1 ms, best fall**\n", "| | µs per step | deepest penetration, mm | contacts, mean |", "|---|---|---|---|"]
    for name in [name for g, name in f.readings if g == "fall"]:
        who = "MuJoCo Euler, " if name.startswith("solref") else "realnoid "
        depth, contacts = f.median("depth", name), f.median("contacts", name)
        lines.append(f"| {who}{name} | {f.least('fall', name):.2f} | {1e3 * depth:.4f} | {contacts:.1f} |")
    return lines


def equal_table(equal):
    lines = ["", "**Chain of five links, released from horizontal: error of its tip at 2 s, at no more CPU time than MuJoCo's RK4 takes**\n"]
    if not equal:
        return lines + ["Not measured: this build of `realnoid accuracy` has no `--peer mujoco`, or MuJoCo could not be had."]
    lines += ["| MuJoCo RK4, step, s | CPU s per s | its error, m | ours, CPU s per s | our error, m | integrator | ratio |", "|---|---|---|---|---|---|---|"]
    for dt, cpu, wrong, own_cpu, own, integrator in equal:
        lines.append(f"| {dt} | {cpu:.2e} | {wrong:.1e} | {own_cpu:.2e} | {own:.1e} | {integrator} | {own / wrong:.1e} |")
    return lines


def page(figures, curves, about):
    machine, version, rounds = about
    rows, equal = goals(figures), equal_time(curves)
    lines = ["# Speed beside the peers\n", "Made by `benches/performance/run --write`; do not edit.\n"]
    lines.append(f"{machine}. Pinocchio 4.1.0 (C++, `-O3 -march=native`), MuJoCo {version}; all from PyPI. One core, shared with whatever else the machine did: quote ratios.\n")
    fall = min(("semi_implicit_euler", "implicit_midpoint"), key=lambda name: figures.least("fall", name))
    deepest = figures.median("depth", fall), figures.median("depth", "solref 0.02")
    table, missed = summary(rows, deepest, equal)
    lines += table
    reasons = [f"- {what}: {REASONS[key]}" for key, what, *_ in rows if key in missed]
    more = {"depth": "penetration", "chain5": "chain of five links"}
    reasons += [f"- {what}: {REASONS[key]}" for key, what in more.items() if key in missed]
    if reasons:
        lines += ["\n## What is missed, and what stands in the way\n", *reasons]
    lines += [
        "\n## What is compared\n",
        "Pinocchio's `aba` fills more outputs than accelerations (placements of all joints among them). An `mj_step` does more than a step of ours where it fills sensors and energies, and",
        "less where it does not read out the poses of links. Both get the same URDF, start and step; ours is a world with idle drives. States of robots side by side stay in lanes;",
        "`_copied` has the copying in and out of every robot. The stack is moved between the batches of lane kernels, because its place changes their time.\n",
    ]
    return "\n".join(lines + raw(figures, rounds) + equal_table(equal)) + "\n"
