// A world whose bodies turn by as much as they do.
#pragma once
#include <vector>
#include "btBulletDynamicsCommon.h"

namespace realnoid::bullet {

// Where a body will be. Bullet's own (btTransformUtil) cuts a turn at 45°.
btTransform ahead(const btTransform& from, const btRigidBody& b, double time);

inline btTransform ahead(const btRigidBody& b, double time) { return ahead(b.getWorldTransform(), b, time); }

// Bullet's world, but for turns of more than 45° in a step.
class Dynamics : public btDiscreteDynamicsWorld {
public:
    using btDiscreteDynamicsWorld::btDiscreteDynamicsWorld;

protected:
    void integrateTransforms(btScalar h) override;

private:
    std::vector<btTransform> before_;
};

}  // namespace realnoid::bullet
