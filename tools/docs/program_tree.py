# SPDX-License-Identifier: Apache-2.0
"""What a program prints with --option-tree: its options, sub-commands and the keys of its configuration."""
import dataclasses
import json


@dataclasses.dataclass
class Option:
    """names: ["-o", "--output"], or ["SOURCE"] of a positional. value: what it takes, such as FILE; empty for a flag."""

    names: list
    positional: bool
    value: str
    several: bool
    required: bool
    default: str
    group: str
    description: str
    needs: list
    excludes: list

    def files(self):
        """Returns what a shell completes after it: "file", "folder", or "" where it cannot know."""
        if self.value == "DIR":
            return "folder"
        if self.value.startswith("FILE") or self.positional and self.names[0] in ("SOURCE", "RIGHT", "FILE", "DATA"):
            return "file"
        return ""


@dataclasses.dataclass
class Command:
    """A program or one of its sub-commands. keys: [{"name": "section.key", "allowed": text}] of its configuration."""

    name: str
    description: str
    footer: str
    options: list
    commands: list
    keys: list

    def flags(self):
        return [option for option in self.options if not option.positional]

    def positionals(self):
        return [option for option in self.options if option.positional]


def _command(tree):
    return Command(
        name=tree["name"],
        description=tree["description"],
        footer=tree["footer"],
        options=[Option(**option) for option in tree["options"]],
        commands=[_command(command) for command in tree["commands"]],
        keys=tree.get("keys", []),
    )


def read_tree(text):
    """Returns the program that the text describes."""
    return _command(json.loads(text))
