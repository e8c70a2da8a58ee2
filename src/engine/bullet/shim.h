// The face of Bullet towards Rust: no header of Bullet is seen from here.
#pragma once
#include <cstddef>
#include <memory>
#include "rust/cxx.h"

namespace realnoid::bullet {

struct Spec;
struct StepInput;
struct MotorInput;
struct PairInput;
struct Moving;
struct Contact;
struct JointForce;

class World {
public:
    explicit World(const Spec& spec);
    ~World();
    World(const World&) = delete;
    World& operator=(const World&) = delete;

    void step(const StepInput& input, rust::Slice<const MotorInput> motors, rust::Slice<const PairInput> pairs,
              rust::Slice<double> efforts, rust::Slice<Moving> bodies);
    void contacts(rust::Vec<Contact>& out) const;
    void joint_forces(rust::Slice<JointForce> out) const;
    void wake();

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

std::unique_ptr<World> build(const Spec& spec);
std::size_t worlds();

}  // namespace realnoid::bullet
