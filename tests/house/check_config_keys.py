# SPDX-License-Identifier: Apache-2.0
"""Finds keys of the configuration that nothing reads.

Usage: check_config_keys.py [ROOT]. Takes the keys and their fields from the table in config_keys.cpp, and looks for each
field in the other sources of daemon/: config.source.loop, or wanted.loop where wanted is a Config::Source. What only checks
and stores a value (config.*, config_keys.*) does not count. Exit status 1 when a key is not read.
"""
import functools
import pathlib
import re
import sys

# These read nothing: they fill the configuration.
PARSERS = {"config.h", "config.cpp", "config_keys.h", "config_keys.cpp"}
# Keys that only say whether the rest of the file is accepted; config.cpp is where they are read.
DECIDES_IN_PARSER = {"socket.insecure", "match.preset"}
# Structures that go whole to kernels/, capture/, pipeline/ and trust/. tests/daemon/config_effect_test.cpp, tests/trust/judge_test.cpp and
# tests/pipeline/distance_limits_test.cpp show
# that each field counts there.
# Keys that config_keys.cpp makes of the tables match_fields() and scan_fields() are of this kind.
HANDED_ON = {"match.options", "rectify.geometry", "trust.options", "output"}

STRING_OR_COMMENT = re.compile(r'"(?:\\.|[^"\\\n])*"|//[^\n]*|/\*.*?\*/', re.DOTALL)
KEY = re.compile(r'push_back\(\s*(?:\w+(?:<[\w:<>]+>)?\(|\{)\s*"(\w+)",\s*"(\w+)"(.*?)\);\n', re.DOTALL)
ROOT_NAME = re.compile(r"\bConfig&?\s+(\w+)\s*[,;()={]")
SECTION_NAME = re.compile(r"\bConfig::(\w+)&?\s+(\w+)\s*[,;)=]")


def fields_of_keys(table):
    """{"section.key": path of its field below Config} of the text of config_keys.cpp."""
    fields = {}
    for section, name, rest in KEY.findall(table):
        field = re.search(r"FIELD\(([\w.]+)\)", rest)
        setter = re.search(r"\b(set_\w+)\b", rest)
        if not field and setter:
            body = table[table.index(f"bool {setter.group(1)}("):]
            field = re.search(r"\bconfig\.([\w.]+) = ", body)
        if not field:
            raise ValueError(f"config_keys.cpp: no field found for the key {section}.{name}; check_config_keys.py must learn it")
        fields[f"{section}.{name}"] = field.group(1)
    if len(fields) != table.count("push_back("):
        raise ValueError(f"config_keys.cpp: {table.count('push_back(')} keys, of which {len(fields)} were understood; "
                         "check_config_keys.py must learn the rest")
    return fields


def snake(name):
    return re.sub(r"(?<=[a-z])(?=[A-Z])", "_", name).lower()


@functools.lru_cache(maxsize=None)
def reads(text, roots):
    """Paths below Config that a source reads, as a set. roots: names of whole configurations."""
    found = set()
    text = STRING_OR_COMMENT.sub('""', text)
    names = {name: [""] for name in roots}
    for section, name in SECTION_NAME.findall(text):
        names.setdefault(name, []).append(snake(section) + ".")
    for name, prefixes in names.items():
        # Up to the last field; a value that is given to it is no reading.
        for path in re.findall(rf"\b{name}(?:\(\))?\.(\w+(?:\.\w+)*)(?!\w)(?!\s*=[^=])", text):
            found.update(prefix + path for prefix in prefixes)
    return found


def is_read(field, paths):
    """Whether one of the paths is the field, a part of it, or a structure with it that is handed on."""
    whole = {field} | {path for path in HANDED_ON if field.startswith(path + ".")}
    return any(path in whole or path.startswith(field + ".") for path in paths)


def keys_of_products(proto):
    """Keys that switch a product on: configured_products.cpp reads those that disparity.proto names."""
    return set(re.findall(r'\bkey: "([\w.]+)"', proto))


def sources_of(daemon):
    """{file: text} of the C++ in a folder."""
    return {path: path.read_text(encoding="utf-8") for path in sorted(daemon.rglob("*")) if path.suffix in {".h", ".cpp"}}


def unread_keys(sources):
    """Keys that none of the daemon's sources reads."""
    tables = [path for path in sources if path.name == "config_keys.cpp"]
    if len(tables) != 1:
        raise ValueError(f"found {len(tables)} files config_keys.cpp, allowed: one")
    fields = fields_of_keys(sources[tables[0]])
    roots = frozenset(name for text in sources.values() for name in ROOT_NAME.findall(text))
    used, in_parser = set(), set()
    for path, text in sources.items():
        if path.name not in PARSERS:
            used |= reads(text, roots)
        elif path.name == "config.cpp":
            in_parser |= reads(text, roots)
    return [key for key, field in fields.items()
            if not is_read(field, in_parser if key in DECIDES_IN_PARSER else used)]


def main():
    root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ".").resolve()
    products = keys_of_products((root / "proto/disparity.proto").read_text(encoding="utf-8"))
    unread = [key for key in unread_keys(sources_of(root / "daemon")) if key not in products]
    for key in unread:
        print(f"the key {key} is never read: use its field, or remove it from config_keys.cpp, config.h and "
              "disparityd.example.toml")
    if not unread:
        print("every key of the configuration is read")
    return 1 if unread else 0


if __name__ == "__main__":
    sys.exit(main())
