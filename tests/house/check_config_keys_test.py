# SPDX-License-Identifier: Apache-2.0
"""check_config_keys.py must find a key that nothing reads: in the daemon's own sources, and in made ones."""
import pathlib
import re
import unittest

import check_config_keys

PROJECT = pathlib.Path(__file__).resolve().parents[2]
TABLE = """
bool set_region(Config& config, const ConfigValue& value) {
    config.rectify.geometry.region = {};
    return true;
}
void add(std::vector<ConfigKey>& keys) {
    keys.push_back(bool_key("source", "loop", FIELD(source.loop)));
    keys.push_back(name_key<Pace>("source", "pace",
                                  {{"a", Pace::a}}, FIELD(source.pace)));
    keys.push_back(range_key("shared_memory", "slots", 2, 64, FIELD(shared_memory.slots)));
    keys.push_back({"rectify", "region", "[]", std::vector<int>{}, set_region, get_region});
}
"""
READER = """
void start(const Config& config, const Config::SharedMemory& memory) {
    open(config.source.loop, config.source.pace == Pace::a, config.rectify.geometry, memory.slots);
}
"""


def made(reader=READER, table=TABLE, parser=""):
    files = {"config_keys.cpp": table, "engine.cpp": reader, "config.cpp": parser}
    return check_config_keys.unread_keys({pathlib.Path("daemon", name): text for name, text in files.items()})


class CheckConfigKeys(unittest.TestCase):
    def test_accepts_keys_that_are_read(self):
        self.assertEqual(made(), [])

    def test_finds_a_key_that_nothing_reads(self):
        for was, now, key in (
            ("config.source.loop", "true", "source.loop"),
            ("config.source.loop", "false /* config.source.loop */", "source.loop"),
            ("config.source.loop", 'text("config.source.loop")', "source.loop"),
            ("config.source.loop", "other.source.loop", "source.loop"),
            ("config.source.loop", "config.source.loops", "source.loop"),
            ("memory.slots", "memory.bytes", "shared_memory.slots"),
            ("memory.slots", "config.pipeline.slots", "shared_memory.slots"),
            ("config.rectify.geometry", "{}", "rectify.region"),
            ("    open(config.source.loop, ", "    config.source.loop = true;\n    open(true, ", "source.loop"),
        ):
            with self.subTest(now=now):
                self.assertIn(was, READER)
                self.assertEqual(made(READER.replace(was, now)), [key])

    def test_the_parser_is_no_reader(self):
        parser = "void check(const Config& config) { refuse(config.source.loop); }"
        self.assertEqual(made(READER.replace("config.source.loop", "true"), parser=parser), ["source.loop"])

    def test_refuses_a_table_that_it_does_not_understand(self):
        for table in (TABLE.replace("FIELD(source.loop)", "somehow"), TABLE.replace('bool_key("source", "loop"', "bool_key(LOOP")):
            with self.subTest(table=table), self.assertRaises(ValueError):
                made(table=table)

    def test_finds_every_key_of_the_daemon_once_its_field_is_not_read(self):
        sources = check_config_keys.sources_of(PROJECT / "daemon")
        table = next(text for path, text in sources.items() if path.name == "config_keys.cpp")
        fields = check_config_keys.fields_of_keys(table)
        self.assertIn("record.max_s", fields)
        for key, field in fields.items():
            handed_on = [path for path in check_config_keys.HANDED_ON if field.startswith(path + ".")]
            gone = [field.rsplit(".", 1)[1]] + [path.rsplit(".", 1)[-1] for path in handed_on]
            pattern = re.compile(rf"\.({'|'.join(gone)})\b")
            decides = key in check_config_keys.DECIDES_IN_PARSER
            spared = check_config_keys.PARSERS - ({"config.cpp"} if decides else set())
            changed = {path: text if path.name in spared else pattern.sub(".gone", text) for path, text in sources.items()}
            with self.subTest(key=key):
                self.assertIn(key, check_config_keys.unread_keys(changed))


if __name__ == "__main__":
    unittest.main()
