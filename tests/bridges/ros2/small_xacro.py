# SPDX-License-Identifier: Apache-2.0
"""Expands as much of xacro as bridges/ros2/description uses, where ROS's own is not installed. Refuses all else.

expand(file, arguments) returns the robot as an element of xml.etree.
"""
import ast
import math
import pathlib
import re
import xml.etree.ElementTree as ElementTree

XACRO = "{http://www.ros.org/wiki/xacro}"
# "name", "name:=value" or "name:='a value'" in the params of a macro.
PARAM = re.compile(r"(\w+)(?::=('[^']*'|\S+))?")


class Fatal(Exception):
    """What xacro.fatal() of the file says."""


class Functions:
    """What expressions reach below the name xacro."""

    @staticmethod
    def fatal(text):
        raise Fatal(text)


def value_of(text):
    """A number or a truth value where the text is one, as properties and parameters have them."""
    if text in ("true", "false"):
        return text == "true"
    try:
        return ast.literal_eval(text)
    except (ValueError, SyntaxError):
        return text


class Expander:
    def __init__(self, folder, arguments):
        self.folder = folder
        self.arguments = dict(arguments)
        self.macros = {}

    def text(self, text, names):
        """Replaces $(arg NAME), also in expressions, then ${EXPRESSION}; one that is all of the text keeps its type."""
        text = re.sub(r"\$\(arg (\w+)\)", lambda found: self.arguments[found.group(1)], text or "")
        known = {"pi": math.pi, "xacro": Functions, **names}

        def evaluate(expression):
            return eval(expression, {"__builtins__": {}}, known)  # the file is the project's own

        whole = re.fullmatch(r"\$\{([^}]*)\}", text)
        return evaluate(whole.group(1)) if whole else re.sub(r"\$\{([^}]*)\}", lambda found: str(evaluate(found.group(1))), text)

    def call(self, macro, element, names):
        params, body = self.macros[macro]
        given = {name: self.text(value, names) for name, value in element.attrib.items()}
        unknown = set(given) - {name for name, _ in params}
        assert not unknown, f"{macro} has no parameter {unknown}"
        local = {}
        for name, default in params:
            assert name in given or default is not None, f"{macro} needs {name}"
            value = given.get(name, default)
            local[name] = value_of(value) if isinstance(value, str) else value
        return self.children(body, local)

    def children(self, element, names):
        """The expanded elements inside of an element; properties change `names`."""
        assert not self.text(element.text, names).strip(), f"there is text in {element.tag}"
        found = []
        for child in element:
            found += self.element(child, names)
        return found

    def element(self, element, names):
        tag = element.tag[len(XACRO):] if element.tag.startswith(XACRO) else None
        if tag is None:
            copy = ElementTree.Element(element.tag, {name: str(self.text(value, names)) for name, value in element.attrib.items()})
            copy.extend(self.children(element, names))
            return [copy]
        if tag == "arg":
            self.arguments.setdefault(element.get("name"), element.attrib["default"])
        elif tag == "include":
            return self.children(ElementTree.parse(self.folder / element.get("filename")).getroot(), names)
        elif tag == "property":
            names[element.get("name")] = value_of(self.text(element.get("value"), names))
        elif tag == "macro":
            params = [(name, default.strip("'") if default else None) for name, default in PARAM.findall(element.get("params"))]
            self.macros[element.get("name")] = (params, element)
        elif tag in ("if", "unless"):
            truth = self.text(element.get("value"), names)
            truth = value_of(truth) if isinstance(truth, str) else truth
            assert isinstance(truth, bool), f"{element.get('value')} is neither true nor false"
            return self.children(element, names) if truth == (tag == "if") else []
        else:
            return self.call(tag, element, names)
        return []


def expand(file, arguments):
    return Expander(pathlib.Path(file).parent, arguments).element(ElementTree.parse(file).getroot(), {})[0]
