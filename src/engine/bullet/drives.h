// What a step sets anew at the joints of a world: motors, ranges, ways.
#pragma once
#include <array>
#include <memory>
#include "btBulletDynamicsCommon.h"

namespace realnoid::bullet {

struct MotorInput;
struct PairInput;

// A degree of freedom that can be driven: a constraint of nothing but a motor, so that what it gave is known.
struct Drive {
    std::unique_ptr<btGeneric6DofSpring2Constraint> constraint;
    int dof = 0;
    // Whose stops are told in each step; else null.
    btGeneric6DofSpring2Constraint* far = nullptr;

    // The torque goes to both bodies (but not to the ground); the motor is a row of the solver.
    void set(const MotorInput& in, const btRigidBody& ground);
};

// A joint with a way along x. Bullet pushes the two sides perpendicular to it at the origins of their frames, which are apart by
// the way: force against force makes a torque out of nothing. So the parent's frame goes along with the child's.
struct Slide {
    btGeneric6DofSpring2Constraint* constraint = nullptr;
    btTransform in_parent, in_child;
    double lower = 1, upper = -1;
    void follow() const;
};

// The turn of a 3DOF group about its child's x, where H and B are nearly one axis.
struct Pair {
    std::unique_ptr<btGeneric6DofSpring2Constraint> constraint;
    btTransform in_child;
    void set(const PairInput& in);
};

}  // namespace realnoid::bullet
