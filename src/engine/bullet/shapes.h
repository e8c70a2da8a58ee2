// From a ShapeSpec to Bullet's shape (tables 6-12, 6-13 of the source).
#pragma once
#include <memory>
#include <vector>
#include "btBulletCollisionCommon.h"
#include "shim.h"

namespace realnoid::bullet {

struct ShapeSpec;

// A shape and what it refers to; destroyed in the right order.
struct Leaf {
    std::unique_ptr<btTriangleIndexVertexArray> mesh;
    std::vector<btVector3> corners;
    std::vector<int> triangles;
    std::unique_ptr<btCollisionShape> shape;
    // How far its frame is along z from the one of the ShapeSpec, m.
    double shift = 0;
    int link = -1;
    int index = -1;
    double surface[4] = {};
    const std::vector<std::pair<int, int>>* excluded = nullptr;
};

std::unique_ptr<Leaf> make_leaf(const ShapeSpec& spec);

}  // namespace realnoid::bullet
