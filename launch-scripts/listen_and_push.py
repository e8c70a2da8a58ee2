#!/usr/bin/env python3
"""Listens to the simulated humanoid, and pushes its first axis with 5 N·m. Needs only rclpy."""
import rclpy
from sensor_msgs.msg import JointState

rclpy.init()
node = rclpy.create_node("listen_and_push")
push = node.create_publisher(JointState, "joint_command", 10)

def on_state(s):
    node.get_logger().info(f"{s.name[0]}: {s.position[0]:+.3f} rad {s.velocity[0]:+.3f} rad/s", throttle_duration_sec=0.2)
    push.publish(JointState(name=[s.name[0]], effort=[5.0]))

node.create_subscription(JointState, "joint_states", on_state, 10)
rclpy.spin(node)
