// Who may touch whom, and with which friction and restitution.
#pragma once
#include <vector>
#include "btBulletDynamicsCommon.h"
#include "shapes.h"

namespace realnoid::bullet {

const Leaf* leaf_of(const btCollisionShape* shape);

// The leaf of an object at which a contact is; `child` is its index in a compound.
const Leaf* leaf_at(const btCollisionObject* object, int child);

// False where a link's own text, or a scene's, excludes the pair.
bool may_touch(const Leaf* a, const Leaf* b);

// Three of Bullet's globals. They are set once, to functions without state of their own.
void set_callbacks();

// Gives a body the surface of its shapes; where they have different ones, Bullet asks at each contact.
void set_surface(btRigidBody& body);

// Which objects may touch at all; by their user indices.
struct Filter : btOverlapFilterCallback {
    std::vector<std::vector<bool>> allowed;
    bool needBroadphaseCollision(btBroadphaseProxy* a, btBroadphaseProxy* b) const override {
        auto index = [](btBroadphaseProxy* p) { return static_cast<btCollisionObject*>(p->m_clientObject)->getUserIndex(); };
        return allowed[index(a)][index(b)];
    }
};

}  // namespace realnoid::bullet
