"""What a launch file would start: `launch` has no wheel, so what the files use of it is imitated."""

import functools
import runpy
import sys
import types


class Launched:
    """What `ros2 launch FILE NAME:=VALUE …` would start: commands, and nodes of other packages."""

    def __init__(self, monkeypatch, path, **given):
        self.values, self.commands, self.nodes = dict(given), [], []
        action = lambda name: functools.partial(lambda name, *a, **k: (name, a, k), name)
        actions = ("DeclareLaunchArgument", "ExecuteProcess", "IncludeLaunchDescription")
        members = {
            "launch": {"LaunchDescription": list},
            "launch.actions": {name: action(name) for name in actions},
            "launch.substitutions": {"LaunchConfiguration": lambda name: ("value", name)},
            "launch.launch_description_sources": {"PythonLaunchDescriptionSource": str},
            "launch_ros": {},
            "launch_ros.actions": {"Node": action("Node")},
        }
        for name, content in members.items():
            module = types.ModuleType(name)
            vars(module).update(content)
            monkeypatch.setitem(sys.modules, name, module)
        self.visit(path)

    def visit(self, path):
        for kind, arguments, options in runpy.run_path(str(path))["generate_launch_description"]():
            getattr(self, kind)(*arguments, **options)

    def text(self, part):
        if isinstance(part, tuple):
            return self.values[part[1]]
        return "".join(map(self.text, part)) if isinstance(part, list) else part

    def DeclareLaunchArgument(self, name, default_value, description):
        assert description
        self.values.setdefault(name, self.text(default_value))

    def IncludeLaunchDescription(self, path, launch_arguments=()):
        self.values.update((name, self.text(value)) for name, value in launch_arguments)
        self.visit(path)

    def ExecuteProcess(self, cmd, output):
        assert output == "screen"
        self.commands.append([self.text(part) for part in cmd])

    def Node(self, package, executable, output, arguments=(), parameters=(), namespace="/"):
        assert output == "screen"
        self.nodes.append((package, executable, [self.text(a) for a in arguments], list(parameters), self.text(namespace)))
