#!/usr/bin/env python3
"""Swings the left leg by servo commands for five seconds of simulated time; plots the twist of the foot and what the hip does.

    cargo run --release                    # in another shell
    python launch-scripts/swing_leg.py [OUT]

Needs rclpy. Writes OUT.png (default: swing_leg.png) if matplotlib is there, else OUT.csv. The joint monitor of the hip is shown if the
messages of this repository are installed (colcon build), and left out otherwise.
"""

import csv
import math
import sys

import rclpy
from geometry_msgs.msg import TwistStamped
from rclpy.node import Node
from sensor_msgs.msg import JointState

try:
    from realnoid.msg import JointMonitors
except ImportError:
    JointMonitors = None

DURATION, FREQUENCY, RAMP = 5.0, 0.8, 1.0  # s, Hz, s of simulated time
# Joint: (middle of the swing, amplitude, phase), rad. A negative hip pitch lifts the thigh forward.
HIP = "left_hip"  # a joint group
SWING = {"left_hip_pitch": (-0.3, 0.4, 0.0), "left_knee": (0.6, 0.4, -0.5 * math.pi)}


def seconds(stamp):
    return stamp.sec + 1e-9 * stamp.nanosec


class SwingLeg(Node):
    """Answers every tenth state with the servo targets of that instant, and keeps twists and monitors."""

    def __init__(self):
        super().__init__("swing_leg")
        self.states, self.start, self.elapsed, self.rows, self.monitors = 0, None, 0.0, [], {}
        self.command = self.create_publisher(JointState, "joint_command", 10)
        self.create_subscription(JointState, "joint_states", self.on_state, 100)
        self.create_subscription(TwistStamped, "twist/left_foot", self.on_twist, 100)
        if JointMonitors:
            self.create_subscription(JointMonitors, "joint_monitors", self.on_monitors, 100)

    def on_state(self, state):
        now = seconds(state.header.stamp)
        self.start = now if self.start is None else self.start
        self.elapsed = now - self.start
        self.states += 1
        if self.states % 10 == 1:
            self.command.publish(JointState(name=list(SWING), position=list(self.targets())))

    def targets(self):
        """Zero at first, the full swing after the ramp."""
        share = min(self.elapsed / RAMP, 1.0)
        for middle, amplitude, phase in SWING.values():
            yield share * (middle + amplitude * math.sin(2 * math.pi * FREQUENCY * self.elapsed + phase))

    def on_twist(self, message):
        if self.start is not None:
            v, w = message.twist.linear, message.twist.angular
            self.rows.append((seconds(message.header.stamp) - self.start, v.x, v.y, v.z, w.x, w.y, w.z))

    def on_monitors(self, message):
        hip = next(joint for joint in message.joints if joint.name == HIP)
        if self.start is not None:
            at = seconds(message.header.stamp) - self.start
            self.monitors[at] = (hip.pitch, hip.pitch_speed, hip.pitch_torque)

    def table(self):
        """Twists, and beside each the monitor of the same instant; nan where there is none."""
        return [(*row, *self.monitors.get(row[0], (math.nan,) * 3)) for row in self.rows]


def plot(rows, name):
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    time, *columns = zip(*rows)
    figure, axes = pyplot.subplots(3, sharex=True, figsize=(8, 7), layout="constrained")
    monitor = ("angle, rad", "speed, rad/s", "torque / 10, N·m")
    columns[8] = [torque / 10 for torque in columns[8]]
    parts = (("xyz", columns[:3], "m/s"), ("xyz", columns[3:6], "rad/s"), (monitor, columns[6:], HIP + " pitch"))
    for axis, (labels, part, unit) in zip(axes, parts):
        for label, values in zip(labels, part):
            axis.plot(time, values, label=label)
        axis.set_ylabel(unit)
        axis.grid(alpha=0.3)
        axis.legend(loc="upper right")
    axes[0].set_title("left_foot: velocity of its origin, angular velocity; along its own axes")
    axes[2].set_xlabel("simulated time, s")
    figure.savefig(f"{name}.png", dpi=120)
    return f"{name}.png"


def write(rows, name):
    with open(f"{name}.csv", "w", newline="") as file:
        table = csv.writer(file)
        table.writerow(["time", "vx", "vy", "vz", "wx", "wy", "wz", "hip_pitch", "hip_pitch_speed", "hip_pitch_torque"])
        table.writerows(rows)
    return f"{name}.csv"


def main():
    name = sys.argv[1] if len(sys.argv) > 1 else "swing_leg"
    rclpy.init()
    node = SwingLeg()
    while node.elapsed < DURATION:
        rclpy.spin_once(node)
    try:
        file = plot(node.table(), name)
    except ImportError:
        file = write(node.table(), name)
    print(f"{node.states} states, {len(node.rows)} twists and {len(node.monitors)} monitors in {node.elapsed:.3f} s of simulated time: {file}")
    rclpy.try_shutdown()


if __name__ == "__main__":
    main()
