#!/usr/bin/env python3
"""Swings the left leg by servo commands for five seconds of simulated time, and plots the twist of the foot.

    cargo run --release                    # in another shell
    python launch-scripts/swing_leg.py [OUT]

Needs rclpy. Writes OUT.png (default: swing_leg.png) if matplotlib is there, else OUT.csv.
"""

import csv
import math
import sys

import rclpy
from geometry_msgs.msg import TwistStamped
from rclpy.node import Node
from sensor_msgs.msg import JointState

DURATION, FREQUENCY, RAMP = 5.0, 0.8, 1.0  # s, Hz, s of simulated time
# Joint: (middle of the swing, amplitude, phase), rad. A negative hip pitch lifts the thigh forward.
SWING = {"left_hip_pitch": (-0.3, 0.4, 0.0), "left_knee": (0.6, 0.4, -0.5 * math.pi)}


def seconds(stamp):
    return stamp.sec + 1e-9 * stamp.nanosec


class SwingLeg(Node):
    """Answers every tenth state with the servo targets of that instant, and keeps the twists."""

    def __init__(self):
        super().__init__("swing_leg")
        self.states, self.start, self.elapsed, self.rows = 0, None, 0.0, []
        self.command = self.create_publisher(JointState, "joint_command", 10)
        self.create_subscription(JointState, "joint_states", self.on_state, 100)
        self.create_subscription(TwistStamped, "twist/left_foot", self.on_twist, 100)

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


def plot(rows, name):
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    time, *columns = zip(*rows)
    figure, (linear, angular) = pyplot.subplots(2, sharex=True, figsize=(8, 5), layout="constrained")
    for axis, part, unit in ((linear, columns[:3], "m/s"), (angular, columns[3:], "rad/s")):
        for label, values in zip("xyz", part):
            axis.plot(time, values, label=label)
        axis.set_ylabel(unit)
        axis.grid(alpha=0.3)
        axis.legend(loc="upper right")
    linear.set_title("left_foot: velocity of its origin, angular velocity; along its own axes")
    angular.set_xlabel("simulated time, s")
    figure.savefig(f"{name}.png", dpi=120)
    return f"{name}.png"


def write(rows, name):
    with open(f"{name}.csv", "w", newline="") as file:
        table = csv.writer(file)
        table.writerow(["time", "vx", "vy", "vz", "wx", "wy", "wz"])
        table.writerows(rows)
    return f"{name}.csv"


def main():
    name = sys.argv[1] if len(sys.argv) > 1 else "swing_leg"
    rclpy.init()
    node = SwingLeg()
    while node.elapsed < DURATION:
        rclpy.spin_once(node)
    try:
        file = plot(node.rows, name)
    except ImportError:
        file = write(node.rows, name)
    print(f"{node.states} states and {len(node.rows)} twists in {node.elapsed:.3f} s of simulated time: {file}")
    rclpy.try_shutdown()


if __name__ == "__main__":
    main()
