// Shapes. Bullet's margin belongs to the outside of its balls, boxes and cylinders, but is added to cones, hulls and to what
// only has a support function. Those are made smaller by it first, so that they end where the shape ends (facts/engines.md D).
#include "shapes.h"
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <tuple>
#include <utility>
#include "LinearMath/btConvexHullComputer.h"
#include "realnoid/src/engine/bullet/bridge.rs.h"

namespace realnoid::bullet {

static_assert(sizeof(btScalar) == 8, "the float64 build of Bullet: pkg-config bullet-float64");

namespace {

// Bullet finds penetrations up to about the margin with its fast method. It rounds the edges of what it is added to, m.
constexpr double MARGIN = 5e-4;
// Share of a shape's least size that the margin may take.
constexpr double THIN = 0.1;

// Triangles nearer than this are looked at, m.
constexpr double REACH = 2e-3;

double margin_for(double least) { return std::min(MARGIN, THIN * least); }

// An ellipse across the z axis.
struct Ring {
    double x, y, z;
    btVector3 support(const btVector3& d) const {
        const double a = x * d.x(), b = y * d.y(), length = std::hypot(a, b);
        return length > 0 ? btVector3(x * a / length, y * b / length, z) : btVector3(0, 0, z);
    }
};

// The hull of two of them. Bullet's own cylinders and cones are round only.
class Frustum : public btConvexInternalShape {
public:
    BT_DECLARE_ALIGNED_ALLOCATOR();
    Frustum(const Ring& base, const Ring& top) : base_(base), top_(top) { m_shapeType = CUSTOM_CONVEX_SHAPE_TYPE; }
    btVector3 localGetSupportingVertexWithoutMargin(const btVector3& d) const override {
        const btVector3 low = base_.support(d), high = top_.support(d);
        return high.dot(d) > low.dot(d) ? high : low;
    }
    void batchedUnitVectorGetSupportingVertexWithoutMargin(const btVector3* d, btVector3* out, int n) const override {
        for (int i = 0; i < n; i++) out[i] = localGetSupportingVertexWithoutMargin(d[i]);
    }
    void calculateLocalInertia(btScalar, btVector3& inertia) const override { inertia.setZero(); }
    // Of a mesh Bullet looks only at triangles inside of the box: what is flat would be behind one before it is seen.
    void getAabb(const btTransform& at, btVector3& low, btVector3& high) const override {
        btConvexInternalShape::getAabb(at, low, high);
        low -= btVector3(REACH, REACH, REACH);
        high += btVector3(REACH, REACH, REACH);
    }
    const char* getName() const override { return "Frustum"; }

private:
    Ring base_, top_;
};

// An ellipsoid to which a margin is added.
class Ellipsoid : public btConvexInternalShape {
public:
    BT_DECLARE_ALIGNED_ALLOCATOR();
    explicit Ellipsoid(const btVector3& radii) : radii_(radii) { m_shapeType = CUSTOM_CONVEX_SHAPE_TYPE; }
    btVector3 localGetSupportingVertexWithoutMargin(const btVector3& d) const override {
        const btVector3 scaled = radii_ * d;
        const double length = scaled.length();
        return length > 0 ? radii_ * scaled / length : btVector3(radii_.x(), 0, 0);
    }
    void batchedUnitVectorGetSupportingVertexWithoutMargin(const btVector3* d, btVector3* out, int n) const override {
        for (int i = 0; i < n; i++) out[i] = localGetSupportingVertexWithoutMargin(d[i]);
    }
    void calculateLocalInertia(btScalar, btVector3& inertia) const override { inertia.setZero(); }
    const char* getName() const override { return "Ellipsoid"; }

private:
    btVector3 radii_;
};

std::unique_ptr<btCollisionShape> balls(const ShapeSpec& s) {
    std::vector<btVector3> centers;
    std::vector<btScalar> radii;
    for (std::size_t i = 0; i + 4 <= s.numbers.size(); i += 4) {
        centers.emplace_back(s.numbers[i], s.numbers[i + 1], s.numbers[i + 2]);
        radii.push_back(s.numbers[i + 3] + s.margin);
    }
    if (radii.empty()) throw std::invalid_argument("a shape of no balls");
    auto shape = std::make_unique<btMultiSphereShape>(centers.data(), radii.data(), int(radii.size()));
    // The core that Bullet works with stays a hull of balls, or of points.
    shape->setMargin(*std::min_element(radii.begin(), radii.end()));
    return shape;
}

std::unique_ptr<btCollisionShape> ellipsoid(const ShapeSpec& s) {
    const btVector3 radii(s.size[0], s.size[1], s.size[2]);
    if (s.margin > 0) {
        auto shape = std::make_unique<Ellipsoid>(radii);
        shape->setMargin(s.margin);
        return shape;
    }
    const btVector3 center(0, 0, 0);
    const btScalar one = 1;
    auto shape = std::make_unique<btMultiSphereShape>(&center, &one, 1);
    shape->setLocalScaling(radii);
    // Not more than the least radius of curvature: what is left when it is taken away is convex.
    const double least = radii[radii.minAxis()], most = radii[radii.maxAxis()];
    shape->setMargin(THIN * least * least / most);
    return shape;
}

// Two rings that, with the margin `m` around them, have the shape of the rings r, t: the ends and the side, which leans, have
// gone inwards by m. Exact for round ones; of an ellipse, at its axes.
std::pair<Ring, Ring> inside(const Ring& r, const Ring& t, double m) {
    const double length = t.z - r.z;
    const double low = r.z + std::min(m, 0.5 * length), high = std::max(t.z - m, low);
    auto at = [&](double from, double to, double z) {
        const double lean = length > 0 ? (from - to) / length : 0;
        return from - lean * (z - r.z) - m * std::sqrt(1 + lean * lean);
    };
    // Where a pointed one comes to its point.
    auto tip = [&](double from, double to) {
        const double lean = (from - to) / length;
        return lean > 0 ? r.z + (from - m * std::sqrt(1 + lean * lean)) / lean : high;
    };
    const double end = length > 0 ? std::max(std::min({high, tip(r.x, t.x), tip(r.y, t.y)}), low) : high;
    auto ring = [&](double z) {
        return Ring{std::max(at(r.x, t.x, z), 0.0), std::max(at(r.y, t.y, z), 0.0), z};
    };
    return {ring(low), ring(end)};
}

std::unique_ptr<btCollisionShape> frustum(const Ring& base, const Ring& top, double margin) {
    const double least = std::min({base.x, base.y, top.z - base.z > 0 ? top.z - base.z : base.x});
    // A disc is as thick as its margin.
    const double m = margin > 0 ? margin : (top.z > base.z ? 1 : 0.1) * margin_for(least);
    const auto rings = margin > 0 ? std::pair(base, top) : inside(base, top, m);
    auto shape = std::make_unique<Frustum>(rings.first, rings.second);
    shape->setMargin(m);
    return shape;
}

// Round: Bullet's own, whose frame is in the middle of its height.
void cone(const ShapeSpec& s, Leaf& leaf) {
    const double radius = s.size[0], half = s.size[1], m = s.margin > 0 ? s.margin : margin_for(std::min(radius, half));
    Ring base{radius, radius, -half}, tip{0, 0, half};
    if (s.margin == 0) std::tie(base, tip) = inside(base, tip, m);
    auto shape = std::make_unique<btConeShapeZ>(base.x, tip.z - base.z);
    shape->setMargin(m);
    leaf.shift = 0.5 * (base.z + tip.z);
    leaf.shape = std::move(shape);
}

// A box whose margin is added is rounded: the hull of a ball at each corner.
std::unique_ptr<btCollisionShape> box(const ShapeSpec& s) {
    const btVector3 half(s.size[0], s.size[1], s.size[2]);
    if (s.margin == 0) return std::make_unique<btBoxShape>(half);
    btVector3 centers[8];
    btScalar radii[8];
    for (int i = 0; i < 8; i++) {
        centers[i] = half * btVector3(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1);
        radii[i] = s.margin;
    }
    auto shape = std::make_unique<btMultiSphereShape>(centers, radii, 8);
    shape->setMargin(s.margin);
    return shape;
}

// Each face goes inwards by the margin.
std::unique_ptr<btCollisionShape> hull(const ShapeSpec& s) {
    const int count = int(s.numbers.size() / 3);
    btConvexHullComputer computer;
    const int stride = 3 * sizeof(double);
    const double shrunk = s.margin > 0 ? computer.compute(s.numbers.data(), stride, count, 0, 0)
                                       : computer.compute(s.numbers.data(), stride, count, MARGIN, THIN);
    auto shape = std::make_unique<btConvexHullShape>();
    for (int i = 0; i < computer.vertices.size(); i++) shape->addPoint(computer.vertices[i], false);
    // A flat one has no inside.
    if (computer.vertices.size() < 4)
        for (int i = 0; i < count; i++)
            shape->addPoint(btVector3(s.numbers[3 * i], s.numbers[3 * i + 1], s.numbers[3 * i + 2]), false);
    shape->recalcLocalAabb();
    if (shape->getNumPoints() == 0) throw std::invalid_argument("a hull without corners");
    shape->setMargin(s.margin > 0 ? s.margin : std::max(shrunk, 0.0));
    return shape;
}

void mesh(const ShapeSpec& s, Leaf& leaf) {
    for (std::size_t i = 0; i + 3 <= s.numbers.size(); i += 3)
        leaf.corners.emplace_back(s.numbers[i], s.numbers[i + 1], s.numbers[i + 2]);
    leaf.triangles.assign(s.triangles.begin(), s.triangles.end());
    const int corners = int(leaf.corners.size());
    for (int i : leaf.triangles)
        if (i < 0 || i >= corners) throw std::out_of_range("a triangle of a mesh has a corner that is not there");
    if (leaf.triangles.size() < 3) throw std::invalid_argument("a mesh without triangles");
    leaf.mesh = std::make_unique<btTriangleIndexVertexArray>(int(leaf.triangles.size() / 3), leaf.triangles.data(),
                                                             int(3 * sizeof(int)), corners, &leaf.corners[0][0],
                                                             int(sizeof(btVector3)));
    leaf.shape = std::make_unique<btBvhTriangleMeshShape>(leaf.mesh.get(), true);
    leaf.shape->setMargin(s.margin);
}

std::unique_ptr<btCollisionShape> cylinder(const ShapeSpec& s) {
    const double radius = s.size[0], half = s.size[1];
    if (s.margin > 0) return frustum({radius, radius, -half}, {radius, radius, half}, s.margin);
    return std::make_unique<btCylinderShapeZ>(btVector3(radius, radius, half));
}

}  // namespace

std::unique_ptr<Leaf> make_leaf(const ShapeSpec& s) {
    auto leaf = std::make_unique<Leaf>();
    leaf->link = s.link;
    std::copy(s.surface.begin(), s.surface.end(), leaf->surface);
    switch (s.kind) {
    case ShapeKind::Plane: leaf->shape = std::make_unique<btStaticPlaneShape>(btVector3(0, 0, 1), s.margin); break;
    case ShapeKind::Box: leaf->shape = box(s); break;
    case ShapeKind::Balls: leaf->shape = balls(s); break;
    case ShapeKind::Ellipsoid: leaf->shape = ellipsoid(s); break;
    case ShapeKind::Cylinder: leaf->shape = cylinder(s); break;
    case ShapeKind::Cone: cone(s, *leaf); break;
    case ShapeKind::Frustum: {
        const double x = s.size[0], y = s.size[1], top = s.size[2], half = s.size[3];
        leaf->shape = frustum({x, y, -half}, {x * top, y * top, half}, s.margin);
        break;
    }
    case ShapeKind::Hull: leaf->shape = hull(s); break;
    case ShapeKind::Mesh: mesh(s, *leaf); break;
    default: throw std::invalid_argument("a shape of no known kind");
    }
    leaf->shape->setUserPointer(leaf.get());
    return leaf;
}

}  // namespace realnoid::bullet
