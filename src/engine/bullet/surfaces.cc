// Who may touch whom, and with which friction and restitution.
#include "surfaces.h"
#include <algorithm>
#include <mutex>
#include "BulletCollision/CollisionDispatch/btCompoundCompoundCollisionAlgorithm.h"
#include "BulletCollision/CollisionDispatch/btCompoundCollisionAlgorithm.h"
#include "BulletCollision/CollisionDispatch/btManifoldResult.h"

namespace realnoid::bullet {

const Leaf* leaf_of(const btCollisionShape* shape) { return static_cast<const Leaf*>(shape->getUserPointer()); }

const Leaf* leaf_at(const btCollisionObject* object, int child) {
    const btCollisionShape* shape = object->getCollisionShape();
    if (!shape->isCompound()) return leaf_of(shape);
    const auto* compound = static_cast<const btCompoundShape*>(shape);
    if (child < 0 || child >= compound->getNumChildShapes()) child = 0;
    return leaf_of(compound->getChildShape(child));
}

bool may_touch(const Leaf* a, const Leaf* b) {
    if (!a || !b || a->link < 0 || b->link < 0 || !a->excluded) return true;
    const std::pair<int, int> pair = std::minmax(a->link, b->link);
    return !std::binary_search(a->excluded->begin(), a->excluded->end(), pair);
}

namespace {

// Bullet asks this of every pair of shapes inside of compounds.
bool leaves_may_touch(const btCollisionShape* a, const btCollisionShape* b) {
    return a->isCompound() || b->isCompound() || may_touch(leaf_of(a), leaf_of(b));
}

// B-8 E to H, for bodies whose shapes have different surfaces; Bullet's own rules are the same ones, but per body.
bool mix_surfaces(btManifoldPoint& p, const btCollisionObjectWrapper* a, int, int child_a, const btCollisionObjectWrapper* b,
                  int, int child_b) {
    const Leaf* x = leaf_at(a->getCollisionObject(), child_a);
    const Leaf* y = leaf_at(b->getCollisionObject(), child_b);
    if (!x || !y) return false;
    p.m_combinedFriction = x->surface[0] * y->surface[0];
    p.m_combinedRollingFriction = x->surface[1] * y->surface[0] + y->surface[1] * x->surface[0];
    p.m_combinedSpinningFriction = x->surface[2] * y->surface[0] + y->surface[2] * x->surface[0];
    p.m_combinedRestitution = x->surface[3] * y->surface[3];
    return true;
}

}  // namespace

void set_callbacks() {
    static std::once_flag once;
    std::call_once(once, [] {
        gContactAddedCallback = mix_surfaces;
        gCompoundChildShapePairCallback = leaves_may_touch;
        gCompoundCompoundChildShapePairCallback = leaves_may_touch;
    });
}

void set_surface(btRigidBody& body) {
    const btCollisionShape* shape = body.getCollisionShape();
    const int children = shape->isCompound() ? static_cast<const btCompoundShape*>(shape)->getNumChildShapes() : 1;
    const Leaf* first = leaf_at(&body, 0);
    if (!first) return;
    body.setFriction(first->surface[0]);
    body.setRollingFriction(first->surface[1]);
    body.setSpinningFriction(first->surface[2]);
    body.setRestitution(first->surface[3]);
    for (int i = 1; i < children; i++)
        if (!std::equal(first->surface, first->surface + 4, leaf_at(&body, i)->surface))
            body.setCollisionFlags(body.getCollisionFlags() | btCollisionObject::CF_CUSTOM_MATERIAL_CALLBACK);
}

}  // namespace realnoid::bullet
