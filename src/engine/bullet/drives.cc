#include "drives.h"
#include <algorithm>
#include "realnoid/src/engine/bullet/bridge.rs.h"

namespace realnoid::bullet {

namespace {

// A window about the present angle, whose ends are stops if they are near; Bullet's sign is the opposite. Not by setLimit,
// which wraps each end by itself. Bullet's row is along a unit vector, so the window is in its measure.
void limit(btGeneric6DofSpring2Constraint& c, int axis, const std::array<double, 2>& stop) {
    constexpr double NEAR = 1;
    btRotationalLimitMotor2& limit = *c.getRotationalLimitMotor(axis);
    const bool none = stop[0] < -NEAR && stop[1] > NEAR;
    c.calculateTransforms();
    const double angle = c.getAngle(axis);
    limit.m_loLimit = none ? 1 : angle - std::clamp(stop[1], -NEAR, NEAR);
    limit.m_hiLimit = none ? -1 : angle - std::clamp(stop[0], -NEAR, NEAR);
}

}  // namespace

void Drive::set(const MotorInput& in, const btRigidBody& ground) {
    auto& c = *constraint;
    if (far && dof >= 3) limit(*far, dof - 3, in.stop);
    c.setEnabled(in.bound > 0);
    if (in.bound > 0) {
        c.enableMotor(dof, true);
        c.setTargetVelocity(dof, -in.speed);
        c.setMaxMotorForce(dof, std::min(in.bound, 1e30));
        c.setParam(BT_CONSTRAINT_CFM, in.cfm, dof);
    }
    if (in.torque == 0) return;
    c.calculateTransforms();
    btRigidBody &a = c.getRigidBodyA(), &b = c.getRigidBodyB();
    if (dof >= 3) {
        const btVector3 torque = c.getAxis(dof - 3) * in.torque;
        b.applyTorque(torque);
        if (&a != &ground) a.applyTorque(-torque);
        return;
    }
    // Along one line for both.
    const btVector3 force = c.getCalculatedTransformA().getBasis().getColumn(dof) * in.torque;
    const btVector3 at = c.getCalculatedTransformB().getOrigin();
    b.applyForce(force, at - b.getCenterOfMassPosition());
    if (&a != &ground) a.applyForce(-force, at - a.getCenterOfMassPosition());
}

void Slide::follow() const {
    btGeneric6DofSpring2Constraint& c = *constraint;
    const btVector3 child = (c.getRigidBodyB().getCenterOfMassTransform() * in_child).getOrigin();
    const double way = (c.getRigidBodyA().getCenterOfMassTransform() * in_parent).invXform(child).x();
    c.setFrames(in_parent * btTransform(btQuaternion::getIdentity(), btVector3(way, 0, 0)), in_child);
    if (lower <= upper) c.setLimit(0, lower - way, upper - way);
}

void Pair::set(const PairInput& in) {
    btGeneric6DofSpring2Constraint& c = *constraint;
    c.setEnabled(in.on);
    if (!in.on) return;
    // Both sides in one frame: then the row is about the child's x, and its angle 0.
    const btTransform child = c.getRigidBodyB().getCenterOfMassTransform() * in_child;
    c.setFrames(c.getRigidBodyA().getCenterOfMassTransform().inverseTimes(child), in_child);
    limit(c, 0, in.stop);
}

}  // namespace realnoid::bullet
