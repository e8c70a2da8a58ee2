"""Frames from /tf and /tf_static, as far as the tests of markers need them; tf2 has no wheel."""

import math

import numpy
from cyclone import listen as cyclone_listen


def matrix(q):
    """Rotation matrix of a quaternion message."""
    x, y, z, w = q.x, q.y, q.z, q.w
    return numpy.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ])


class Frames:
    """The latest transforms."""

    def __init__(self, probe):
        domain = probe.context.get_domain_id()
        self.streams = [cyclone_listen("tf_static", domain, latched=True), cyclone_listen("tf", domain)]
        self.parents = {}

    def take(self):
        for stream in self.streams:
            for message in stream.take_all():
                for t in message.transforms:
                    p = t.transform.translation
                    pose = matrix(t.transform.rotation), numpy.array([p.x, p.y, p.z])
                    self.parents[t.child_frame_id] = t.header.frame_id, pose

    def complete(self):
        """Does every frame lead to the world?"""
        self.take()
        known = {parent for parent, _ in self.parents.values()} - {"world"}
        return bool(self.parents) and known <= set(self.parents)

    def in_world(self, frame, point):
        while frame != "world":
            frame, (r, p) = self.parents[frame]
            point = r @ point + p
        return point

    def vector(self, frame, vector):
        return self.in_world(frame, vector) - self.in_world(frame, numpy.zeros(3))

    def turn(self, frame):
        """Angle about z in the parent, rad."""
        self.take()
        r, _ = self.parents[frame][1]
        return math.atan2(r[1, 0], r[0, 0])

    @staticmethod
    def apply(pose, p):
        at = numpy.array([pose.position.x, pose.position.y, pose.position.z])
        return matrix(pose.orientation) @ numpy.array([p.x, p.y, p.z]) + at
