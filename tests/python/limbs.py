"""A limb with a joint group and a linear axis, as URDF text; without the tag it is a plain chain of joints."""


def joint(name, kind, parent, child, axis, origin="", inner=""):
    return (
        f"<joint name='{name}' type='{kind}'><parent link='{parent}'/><child link='{child}'/><origin {origin}/>"
        f"<axis xyz='{axis}'/>{inner}</joint>"
    )


def inertial(mass, centre="0.02 0.01 -0.2"):
    return (
        f"<inertial><origin xyz='{centre}' rpy='0.1 0.2 0.3'/><mass value='{mass}'/>"
        "<inertia ixx='0.04' ixy='0.001' ixz='0.002' iyy='0.05' iyz='-0.001' izz='0.02'/></inertial>"
    )


WIDE = "<limit lower='-1.5' upper='1.5' effort='400' velocity='200'/>"
SLIDE = "<limit lower='-0.5' upper='0.5' effort='4000' velocity='20'/>"


def limb(kind, tagged=True, more="", drive=""):
    """base – h, p, b – limb – e – shaft – knee – shin; `kind`: 3dof, cardan, combined_hinge."""
    massive = inertial(0.7) if kind == "combined_hinge" else ""
    apart = "xyz='0.01 0.02 -0.03' rpy='0.1 0 0'" if kind == "combined_hinge" else ""
    last = "" if kind == "3dof" else "xyz='0.03 -0.01 -0.05'"
    tag = f"<realnoid version='1'><joint_group name='hip' type='{kind}' h='h' p='p' b='b' e='e'/>{more}</realnoid>"
    links = {"base": "", "l1": massive, "l2": massive, "limb": inertial(3), "shaft": inertial(1.5, "0.1 0 0.02"), "shin": inertial(2)}
    return "".join(
        [
            "<robot name='limb'>",
            tag if tagged else "",
            *(f"<link name='{name}'>{inner}</link>" for name, inner in links.items()),
            joint("h", "revolute", "base", "l1", "0 0 1", "xyz='0 0.1 1' rpy='0.2 -0.1 0.4'", WIDE),
            joint("p", "revolute", "l1", "l2", "0 1 0", apart, WIDE),
            joint("b", "revolute", "l2", "limb", "1 0 0", last, WIDE),
            joint("e", "prismatic", "limb", "shaft", "1 0 0", "xyz='0.2 0 -0.1'", SLIDE + drive),
            joint("knee", "revolute", "shaft", "shin", "0 0.6 0.8", "xyz='0.1 0 -0.3' rpy='0 0.3 0'", WIDE),
            "</robot>",
        ]
    )
