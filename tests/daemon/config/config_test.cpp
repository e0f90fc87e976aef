// SPDX-License-Identifier: Apache-2.0
#include "daemon/config/config.h"

#include <cstdlib>
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "daemon/config/config_keys.h"
#include "tests/capture/open_files_limit.h"

namespace disparityd {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

std::string refusal(const std::string& text, const std::vector<daemon::Override>& overrides = {}) {
    try {
        daemon::parse_config(text, "my.toml", overrides);
    } catch (const std::invalid_argument& error) {
        return error.what();
    }
    return "(accepted)";
}

std::string read_file(const std::string& path) {
    std::ifstream file(path);
    std::ostringstream text;
    text << file.rdbuf();
    return text.str();
}

/// The lines "key = value" of a file and the keys that are commented out, "#key = value", by "section.key".
std::map<std::string, std::string> lines_of(const std::string& text) {
    std::map<std::string, std::string> found;
    std::istringstream lines(text);
    std::string section;
    for (std::string line; std::getline(lines, line);) {
        const bool prose = line.starts_with("# ");
        const std::size_t begin = line.starts_with('#') ? 1 : 0;
        const auto equals = line.find(" = ");
        if (line.starts_with('[')) {
            section = line.substr(1, line.find(']') - 1);
        } else if (!prose && equals != std::string::npos) {
            found[section + '.' + line.substr(begin, equals - begin)] = line.substr(equals + 3);
        }
    }
    return found;
}

TEST(ExampleFile, HasEveryKeyWithItsDefault) {
    const std::string text = read_file(DISPARITYD_EXAMPLE_CONFIG);
    const daemon::Config defaults;
    auto lines = lines_of(text);
    for (const daemon::ConfigKey& key : daemon::config_keys()) {
        ASSERT_TRUE(lines.contains(full_name(key))) << full_name(key) << " is not in the example file";
        EXPECT_EQ(lines[full_name(key)], daemon::to_text(key.get(defaults))) << full_name(key);
        lines.erase(full_name(key));
    }
    EXPECT_TRUE(lines.empty()) << "no key of the configuration: " << lines.begin()->first;
}

TEST(ExampleFile, LoadsAsTheDefaults) {
    const daemon::Config example = daemon::load_config(DISPARITYD_EXAMPLE_CONFIG, {});
    const daemon::Config defaults = daemon::parse_config("", "empty.toml");
    for (const daemon::ConfigKey& key : daemon::config_keys()) {
        EXPECT_EQ(key.get(example), key.get(defaults)) << full_name(key);
    }
}

TEST(ExampleFile, EveryKeyHasAComment) {
    std::istringstream lines(read_file(DISPARITYD_EXAMPLE_CONFIG));
    std::string before;
    for (std::string line; std::getline(lines, line); before = line) {
        if (line.find(" = ") != std::string::npos && !line.starts_with("# ")) {
            EXPECT_TRUE(before.starts_with('#') || before.find(" = ") != std::string::npos) << line;
        }
    }
}

TEST(ExampleFile, CommentsSayWhichNumbersAreAllowed) {
    std::istringstream lines(read_file(DISPARITYD_EXAMPLE_CONFIG));
    std::string section;
    std::string comment;  // above the key, and above keys that follow without one of their own
    bool commented = false;
    std::map<std::string, std::string> comments;
    for (std::string line; std::getline(lines, line);) {
        const auto equals = line.find(" = ");
        if (line.starts_with('[')) {
            section = line.substr(1, line.find(']') - 1);
        } else if (line.starts_with("# ")) {
            comment = (commented ? comment + ' ' : "") + line.substr(2);
        } else if (equals != std::string::npos) {
            const std::size_t begin = line.starts_with('#') ? 1 : 0;
            comments[section + '.' + line.substr(begin, equals - begin)] = comment;
        }
        commented = line.starts_with("# ");
    }
    int numbers = 0;
    for (const daemon::ConfigKey& key : daemon::config_keys()) {
        if (std::holds_alternative<std::int64_t>(key.example) || std::holds_alternative<double>(key.example)) {
            EXPECT_THAT(comments[full_name(key)], HasSubstr(key.allowed)) << full_name(key);
            ++numbers;
        }
    }
    EXPECT_GT(numbers, 40);
}

TEST(Config, ReadsValuesOfEveryType) {
    const daemon::Config config = daemon::parse_config(R"(
[source]
uri = "recording.mkv"
pace = "fastest"
loop = true
policy = "live"
[rectify]
width = 640
height = 360
region = [10, 20, 300, 200]
[match]
method = "census"
d_min = -16
disparities = 128
median = 5
depth = false
depth_error = true
[socket]
tcp = "[::1]:0"
unix = ""
[log]
level = "warning"
target = "journal"
)",
                                                       "my.toml");
    EXPECT_EQ(config.source.uri, "recording.mkv");
    EXPECT_EQ(config.source.pace, capture::Pace::fastest);
    EXPECT_TRUE(config.source.loop);
    EXPECT_EQ(config.source.policy, daemon::PolicyChoice::live);
    EXPECT_EQ(config.rectify.geometry.width, 640);
    EXPECT_EQ(config.rectify.geometry.region.y, 20);
    EXPECT_EQ(config.rectify.geometry.region.height, 200);
    EXPECT_EQ(config.match.options.method, Method::census);
    EXPECT_EQ(config.match.options.range.first, -16);
    EXPECT_EQ(config.match.options.range.count, 128);
    EXPECT_EQ(config.match.options.post.median, 5);
    EXPECT_FALSE(config.match.depth);
    EXPECT_TRUE(config.match.depth_error);
    EXPECT_FALSE(daemon::Config{}.match.depth_error);
    EXPECT_EQ(config.socket.tcp, "[::1]:0");
    EXPECT_EQ(config.socket.unix_path, "");
    EXPECT_EQ(config.log.level, daemon::LogLevel::warning);
    EXPECT_EQ(config.log.target, daemon::LogTarget::journal);
}

TEST(Config, CoresAreAllOrANumber) {
    const auto cores = [](const std::string& value, const std::vector<daemon::Override>& overrides = {}) {
        return daemon::parse_config("[pipeline]\ncores = " + value + "\n", "my.toml", overrides).pipeline.cores;
    };
    EXPECT_EQ(daemon::Config{}.pipeline.cores, std::nullopt);
    EXPECT_EQ(cores("\"all\""), std::nullopt);
    EXPECT_EQ(cores("2"), 2.0);
    EXPECT_EQ(cores("1.5"), 1.5);
    EXPECT_EQ(cores("\"0.1\""), 0.1);
    EXPECT_EQ(cores("256"), 256.0);
    EXPECT_EQ(cores("2", {daemon::parse_override("pipeline.cores=0.75")}), 0.75);
    EXPECT_EQ(cores("2", {daemon::parse_override("pipeline.cores=all")}), std::nullopt);
}

TEST(Config, UnsetMatchKeysAreThoseOfTheMethod) {
    for (const Method method : {Method::sad, Method::census, Method::sgm}) {
        const DisparityRange range{-32, 96};
        const MatchOptions expected =
            method == Method::sgm ? preset_options(Preset::obstacles, range) : default_options(method, range);
        const std::string text = "[match]\nd_min = -32\nuniqueness = 7\nmethod = \"" + std::string(to_string(method)) +
                                 "\"\ndisparities = 96\n";
        const MatchOptions found = daemon::parse_config(text, "my.toml").match.options;
        EXPECT_EQ(found.method, method);
        EXPECT_EQ(found.post.uniqueness, 7);
        EXPECT_EQ(found.sgm.p1, expected.sgm.p1);
        EXPECT_EQ(found.sgm.p2, expected.sgm.p2);
        EXPECT_EQ(found.sgm.adaptive_p2, expected.sgm.adaptive_p2);
        EXPECT_EQ(found.cost, expected.cost);
        EXPECT_EQ(found.post.interpolate, expected.post.interpolate);
        EXPECT_EQ(found.post.speckle_size, expected.post.speckle_size);
        EXPECT_EQ(found.post.median, expected.post.median);
        EXPECT_EQ(found.post.min_texture, expected.post.min_texture);
        EXPECT_EQ(found.post.local_extrema, expected.post.local_extrema);
    }
}

TEST(Config, APresetIsWhatUnsetKeysAre) {
    for (const Preset preset : {Preset::paper, Preset::dense, Preset::obstacles}) {
        const MatchOptions expected = preset_options(preset, {-32, 96});
        const std::string text =
            "[match]\np1 = 9\nd_min = -32\ndisparities = 96\npreset = \"" + std::string(to_string(preset)) + "\"\n";
        const MatchOptions found = daemon::parse_config(text, "my.toml").match.options;
        EXPECT_EQ(found.sgm.p1, 9);
        EXPECT_EQ(found.cost, expected.cost);
        EXPECT_EQ(found.sgm.paths, expected.sgm.paths);
        EXPECT_EQ(found.sgm.p2, expected.sgm.p2);
        EXPECT_EQ(found.sgm.p2_slope, expected.sgm.p2_slope);
        EXPECT_EQ(found.sgm.calibrated_confidence, expected.sgm.calibrated_confidence);
        EXPECT_EQ(found.post.interpolate, expected.post.interpolate);
        EXPECT_EQ(found.post.guided_median, expected.post.guided_median);
    }
}

// A user who sets a preset in the file that is installed gets it: nothing else in the file is set against it.
TEST(Config, APresetTakesEffectInTheExampleFile) {
    const daemon::Override preset{"match", "preset", "dense", "--set"};
    const MatchOptions found = daemon::load_config(DISPARITYD_EXAMPLE_CONFIG, {preset}).match.options;
    EXPECT_EQ(found.cost, CensusCost::census_7x5_gradient);
    EXPECT_EQ(found.sgm.paths, 4);
    EXPECT_EQ(found.sgm.p1, preset_options(Preset::dense).sgm.p1);
    EXPECT_TRUE(found.post.interpolate);
    EXPECT_EQ(found.post.guided_median, 7);
}

TEST(Config, AFileFromBeforeThereWerePresetsIsToldWhatItGets) {
    EXPECT_THAT(daemon::parse_config("[match]\np1 = 20\n", "my.toml").notes,
                testing::ElementsAre(AllOf(HasSubstr("my.toml: [match] preset: not set"), HasSubstr("\"obstacles\""),
                                           HasSubstr("preset = \"paper\" is as before"))));
    EXPECT_THAT(daemon::parse_config("[match]\np1 = 20\npreset = \"paper\"\n", "my.toml").notes, testing::IsEmpty());
    EXPECT_THAT(daemon::parse_config("[match]\ndisparities = 128\n", "my.toml").notes, testing::IsEmpty());
    EXPECT_THAT(daemon::load_config(DISPARITYD_EXAMPLE_CONFIG, {}).notes, testing::IsEmpty());
}

TEST(Config, APresetIsOfSgmAlone) {
    const daemon::Config config = daemon::parse_config("[match]\npreset = \"dense\"\nmethod = \"census\"\n", "my.toml");
    EXPECT_EQ(config.match.options.cost, CensusCost::census_9x7);
    EXPECT_FALSE(config.match.options.post.interpolate);
    EXPECT_THAT(config.notes, testing::ElementsAre(AllOf(HasSubstr("my.toml:2:1"), HasSubstr("[match] preset"),
                                                         HasSubstr("the method is census"))));
}

TEST(Config, SadDoesNotUseACensusCost) {
    EXPECT_THAT(daemon::parse_config("[match]\nmethod = \"sad\"\ncost = \"census-9x7\"\n", "my.toml").notes,
                testing::ElementsAre(AllOf(HasSubstr("my.toml:3:1"), HasSubstr("[match] cost"), HasSubstr("sad"))));
}

TEST(Config, CommandLineWins) {
    const daemon::Config config = daemon::parse_config(
        "[match]\ndisparities = 64\n[source]\nuri = \"a\"\n", "my.toml",
        {daemon::parse_override("match.disparities=128"), daemon::parse_override("source.uri=b=c.mkv"),
         daemon::parse_override("rectify.region=[1, 2, 3, 4]"), daemon::parse_override("source.loop=true")});
    EXPECT_EQ(config.match.options.range.count, 128);
    EXPECT_EQ(config.source.uri, "b=c.mkv");
    EXPECT_EQ(config.rectify.geometry.region.width, 3);
    EXPECT_TRUE(config.source.loop);
}

struct BadCase {
    const char* name;
    const char* text;
    std::vector<const char*> expected;
};

// What a failure shows; found by GoogleTest.
void PrintTo(const BadCase& bad, std::ostream* out) {
    *out << bad.name;
}

class BadConfig : public ::testing::TestWithParam<BadCase> {};

TEST_P(BadConfig, IsRefusedInOneClearLine) {
    const std::string line = refusal(GetParam().text);
    EXPECT_THAT(line, StartsWith("my.toml:"));
    EXPECT_EQ(line.find('\n'), std::string::npos) << line;
    for (const char* part : GetParam().expected) {
        EXPECT_THAT(line, HasSubstr(part));
    }
}

INSTANTIATE_TEST_SUITE_P(
    Each, BadConfig,
    ::testing::Values(
        BadCase{"unknown_key",
                "[match]\n  disparitys = 64\n",
                {"my.toml:2:3:", "[match] disparitys", "did you mean \"disparities\""}},
        BadCase{"far_from_any_key",
                "[log]\nxylophone = 1\n",
                {"my.toml:2:1:", "unknown key [log] xylophone", "allowed: level, target"}},
        BadCase{"unknown_section", "[sockets]\ntcp = \"\"\n", {"unknown section [sockets]", "did you mean \"socket\""}},
        BadCase{"no_section", "uri = \"scene:vga\"\n", {"my.toml:1:1:", "uri", "outside of a section"}},
        BadCase{"wrong_type",
                "[match]\ndisparities = \"64\"\n",
                {"my.toml:2:1:", "[match] disparities", "found \"64\"", "multiple of 16"}},
        BadCase{"float",
                "[pipeline]\nslots = 4.0\n",
                {"[pipeline] slots", "found 4.0, which is no whole number", "allowed: 2 .. 32"}},
        BadCase{"cores_none",
                "[pipeline]\ncores = 0\n",
                {"my.toml:2:1:", "[pipeline] cores", "found 0", "\"all\" or a number of cores, 0.1 .. 256"}},
        BadCase{"cores_negative", "[pipeline]\ncores = -1.5\n", {"[pipeline] cores", "found -1.5", "0.1 .. 256"}},
        BadCase{"cores_too_many", "[pipeline]\ncores = 257\n", {"[pipeline] cores", "found 257", "0.1 .. 256"}},
        BadCase{"cores_not_finite", "[pipeline]\ncores = nan\n", {"[pipeline] cores", "found nan", "0.1 .. 256"}},
        BadCase{"cores_in_words", "[pipeline]\ncores = \"half\"\n", {"[pipeline] cores", "found \"half\"", "\"all\""}},
        BadCase{"cores_in_percent", "[pipeline]\ncores = \"150%\"\n", {"[pipeline] cores", "found \"150%\""}},
        BadCase{"cores_as_flag", "[pipeline]\ncores = true\n", {"[pipeline] cores", "found true", "\"all\""}},
        BadCase{"flag", "[source]\nloop = 1\n", {"[source] loop", "found 1", "true or false"}},
        BadCase{"negative_disparities", "[match]\ndisparities = -64\n", {"found -64", "16 .. 256"}},
        BadCase{"huge_disparities", "[match]\ndisparities = 4096\n", {"found 4096", "16 .. 256"}},
        BadCase{"odd_disparities", "[match]\ndisparities = 65\n", {"found 65", "multiple of 16"}},
        BadCase{"beyond_int", "[match]\nd_min = 4294967296\n", {"[match] d_min", "found 4294967296", "-256 .. 256"}},
        BadCase{"method",
                "[match]\nmethod = \"sgbm\"\n",
                {"[match] method", "found \"sgbm\"", "\"sgm\" or \"census\" or \"sad\""}},
        BadCase{"paths", "[match]\npaths = 6\n", {"[match] paths", "found 6", "4 or 8"}},
        BadCase{"p1_above_p2",
                "[match]\np1 = 60\np2 = 50\n",
                {"my.toml:2:1:", "[match] p1", "found 60", "less than p2, which is 50"}},
        BadCase{"region_of_three",
                "[rectify]\nregion = [1, 2, 3]\n",
                {"[rectify] region", "found [1, 2, 3]", "[x, y, width, height]"}},
        BadCase{"region_of_text", "[rectify]\nregion = [\"a\"]\n", {"[rectify] region", "found [\"a\"]"}},
        BadCase{"only_width", "[rectify]\nwidth = 640\n", {"my.toml:2:1:", "[rectify] width and height", "640 and 0"}},
        BadCase{"not_toml", "[match\n", {"my.toml:1:", "not TOML"}},
        BadCase{"html", "<!DOCTYPE html>\n<html></html>\n", {"my.toml:1:", "not TOML"}},
        BadCase{"twice",
                "[match]\np1 = 1\np1 = 2\n",
                {"my.toml:3:", "already exists", "allowed: each key and each section once"}},
        BadCase{
            "object_name", "[shared_memory]\nname = \"../x\"\n", {"[shared_memory] name", "found \"../x\"", "letters"}},
        BadCase{"tcp_form",
                "[socket]\ntcp = \"9876\"\n",
                {"my.toml:2:1:", "[socket] tcp", "found \"9876\"", "ADDRESS:PORT"}},
        BadCase{"tcp_port", "[socket]\ntcp = \"127.0.0.1:99999\"\n", {"[socket] tcp", "99999"}},
        BadCase{"tcp_name", "[socket]\ntcp = \"example.com:9876\"\n", {"[socket] tcp", "example.com"}},
        BadCase{"tcp_open",
                "[socket]\ntcp = \"0.0.0.0:9876\"\n",
                {"[socket] tcp", "0.0.0.0:9876", "disparityctl certificates", "insecure = true"}},
        BadCase{"tls_for_everybody",
                "[socket]\ntcp = \"0.0.0.0:9876\"\ncertificate = \"c\"\nkey = \"k\"\n",
                {"my.toml:2:1:", "[socket] tcp", "client_authority and tokens"}},
        BadCase{"tokens_without_tls",
                "[socket]\ntcp = \"0.0.0.0:9876\"\ntokens = \"t\"\n",
                {"my.toml:2:1:", "[socket] tcp", "certificate, key"}},
        BadCase{
            "certificate_alone", "[socket]\ncertificate = \"c\"\n", {"my.toml:2:1:", "certificate", "without its key"}},
        BadCase{"key_alone", "[socket]\nkey = \"k\"\n", {"my.toml:2:1:", "key", "without its certificate"}},
        BadCase{"authority_without_tls",
                "[socket]\nclient_authority = \"a\"\n",
                {"my.toml:2:1:", "client_authority", "TLS"}},
        BadCase{"certificates_unchecked",
                "[access]\ncontrol_certificates = [\"pilot\"]\n",
                {"my.toml:2:1:", "control_certificates", "client_authority"}},
        BadCase{"group_no_list",
                "[access]\ncontrol_groups = \"video\"\n",
                {"my.toml:2:1:", "\"video\"", "names of groups"}},
        BadCase{"group_numbers", "[access]\ncontrol_groups = [44]\n", {"my.toml:2:1:", "found [44]"}},
        BadCase{"group_mixed", "[access]\ncontrol_groups = [\"video\", 44]\n", {"my.toml:2:1:", "array"}},
        BadCase{"group_empty", "[access]\nview_groups = [\"\"]\n", {"my.toml:2:1:", "found [\"\"]"}},
        BadCase{"log_level", "[log]\nlevel = \"verbose\"\n", {"[log] level", "\"debug\" or"}},
        BadCase{"empty_uri", "[source]\nuri = \"\"\n", {"[source] uri", "found \"\""}}),
    [](const auto& parameter) { return std::string(parameter.param.name); });

TEST(Config, InsecureAllowsOtherAddresses) {
    EXPECT_EQ(daemon::parse_config("[socket]\ntcp = \"0.0.0.0:9876\"\ninsecure = true\n", "my.toml").socket.tcp,
              "0.0.0.0:9876");
    EXPECT_EQ(daemon::parse_config("[socket]\ntcp = \"localhost:9876\"\n", "my.toml").socket.tcp, "localhost:9876");
    const std::string tls = "[socket]\ntcp = \"0.0.0.0:9876\"\ncertificate = \"c\"\nkey = \"k\"\n";
    EXPECT_EQ(daemon::parse_config(tls + "tokens = \"t\"\n", "my.toml").socket.tokens, "t");
    const auto config = daemon::parse_config(tls +
                                                 "client_authority = \"a\"\n[access]\ncontrol_certificates = "
                                                 "[\"pilot\", \"b\"]\ncontrol_groups = [\"video\"]\n",
                                             "my.toml");
    EXPECT_EQ(config.socket.client_authority, "a");
    EXPECT_EQ(config.access.control_certificates, (std::vector<std::string>{"pilot", "b"}));
    EXPECT_EQ(config.access.control_groups, std::vector<std::string>{"video"});
    EXPECT_TRUE(config.access.view_groups.empty());
}

TEST(Config, KeysThatTheMethodDoesNotUseAreNoted) {
    const std::string keys = "p1 = 10\np2 = 40\n";
    EXPECT_THAT(daemon::parse_config("[match]\npreset = \"paper\"\n" + keys, "my.toml").notes, testing::IsEmpty());
    EXPECT_THAT(daemon::parse_config("[match]\nmethod = \"sad\"\nmedian = 3\n", "my.toml").notes, testing::IsEmpty());
    EXPECT_THAT(daemon::parse_config("[match]\nmethod = \"sad\"\n" + keys, "my.toml").notes,
                testing::ElementsAre("my.toml:3:1: [match] p1, p2: only sgm uses this, the method is sad"));
    EXPECT_THAT(
        daemon::parse_config("[match]\nmethod = \"census\"\n", "my.toml", {daemon::parse_override("match.paths=4")})
            .notes,
        testing::ElementsAre(AllOf(StartsWith("--set match.paths=4: "), HasSubstr("the method is census"))));
}

// The same default as "disparityctl process --scan" has.
TEST(Config, LeastConfidenceOfAScanFollowsWhatTheConfidenceIs) {
    const auto least = [](const std::string& text) {
        return daemon::parse_config(text, "my.toml").scan.options.min_confidence;
    };
    EXPECT_EQ(least(""), 200);
    EXPECT_EQ(least("[match]\npreset = \"dense\"\n"), 200);
    EXPECT_EQ(least("[match]\npreset = \"paper\"\n"), 1);
    EXPECT_EQ(least("[match]\npreset = \"paper\"\ncalibrated_confidence = true\n"), 200);
    EXPECT_EQ(least("[match]\ncalibrated_confidence = false\n"), 1);
    EXPECT_EQ(least("[match]\nmethod = \"census\"\n"), 1);
    EXPECT_EQ(least("[scan]\nmin_confidence = 200\n[match]\nmethod = \"sad\"\n"), 200);
}

TEST(Config, BadOverrideNamesWhatWasTyped) {
    EXPECT_THAT(refusal("", {daemon::parse_override("match.disparities=7")}),
                AllOf(StartsWith("--set match.disparities=7: "), HasSubstr("found 7")));
    EXPECT_THAT(refusal("", {daemon::parse_override("match.disparities=many")}), HasSubstr("found \"many\""));
    EXPECT_THAT(refusal("", {daemon::parse_override("match.disparites=64")}),
                HasSubstr("did you mean \"disparities\""));
    EXPECT_THAT(refusal("", {{"source", "uri", "", "--source "}}), HasSubstr("--source : [source] uri"));
    EXPECT_THROW(daemon::parse_override("disparities=64"), std::invalid_argument);
    EXPECT_THROW(daemon::parse_override("match.disparities"), std::invalid_argument);
}

std::string repeated(const std::string& text, int times) {
    std::string all;
    for (int i = 0; i < times; ++i) {
        all += text;
    }
    return all;
}

TEST(Config, AKeyIsFoundHoweverItIsWritten) {
    const auto at = [](const std::string& text) { return refusal(text).substr(0, refusal(text).find(": [match] p1")); };
    EXPECT_EQ(at("[match]\np1 = 300\n"), "my.toml:2:1");
    EXPECT_EQ(at("\n[match]\r\n\tp1=300\r\n"), "my.toml:3:2");
    EXPECT_EQ(at("match.p1 = 300\n"), "my.toml:1:7");
    EXPECT_EQ(at("match = { p2 = 310, p1 = 300 }\n"), "my.toml:1:21");
    EXPECT_EQ(at("[match]\n\"p1\" = 300\n"), "my.toml:2:2");
    EXPECT_EQ(at("[match]\np1 = \"\"\"\nmany\nlines\"\"\"\n"), "my.toml:2:1");
    EXPECT_EQ(at("[match]\np1 = 1979-05-27\n"), "my.toml:2:1");
}

// Of several mistakes the same one is told each time.
TEST(Config, SectionsAndKeysAreReadInTheOrderOfTheirNames) {
    EXPECT_THAT(refusal("[socket]\nx = 1\n[match]\ny = 1\nx = 1\n"), HasSubstr("my.toml:5:1: unknown key [match] x"));
}

TEST(Config, WhatIsNotUtf8IsRefusedBeforeItIsParsed) {
    for (const char* bytes : {"\x80", "\xff", "\xc1\xbf", "\xc3", "\xc3(", "\xe0\x9f\x80", "\xed\xa0\x80", "\xef\xbf",
                              "\xf0\x8f\x80\x80", "\xf4\x90\x80\x80", "\xf5\x80\x80\x80"}) {
        EXPECT_THAT(refusal("[source]\nuri = '" + std::string(bytes) + "'\n"),
                    AllOf(StartsWith("my.toml:2: found a byte"), HasSubstr("UTF-8")));
    }
    const std::string characters =
        "\x7f\xc2\x80\xdf\xbf\xe0\xa0\x80\xed\x9f\xbf\xee\x80\x80\xf0\x90\x80\x80\xf4\x8f\xbf\xbf";
    EXPECT_EQ(daemon::parse_config("[source]\nuri = \"" + characters.substr(1) + "\"\n", "my.toml").source.uri,
              characters.substr(1));
}

TEST(Config, WhatIsLongIsRefusedBeforeItIsParsed) {
    const auto too_long = HasSubstr("bytes, allowed: at most 65536");
    EXPECT_THAT(refusal("x = [" + repeated("1,", 100'000) + "]\n"),
                AllOf(StartsWith("my.toml: found 200007"), too_long));
    EXPECT_THAT(refusal("", {daemon::parse_override("match.p1=[" + repeated("1,", 100'000) + "]")}),
                AllOf(StartsWith("--set match.p1=[1,1"), HasSubstr("allowed: 1 .. 192")));
}

TEST(Config, WhatIsDeepIsRefusedBeforeItIsParsed) {
    constexpr int deep = 6'000;  // a parser of TOML recurses as deep
    const std::string key = "a" + repeated(".a", deep) + " = 1\n";
    const auto long_key = AllOf(StartsWith("my.toml:3: found a key of more than 16 parts"), HasSubstr("at most 16"));
    EXPECT_THAT(refusal("[match]\nmethod = \"sgm\"\n" + key), long_key);
    EXPECT_THAT(refusal("\n\n[a" + repeated(" . a", deep) + "]\n"), long_key);
    EXPECT_THAT(refusal("\n\n\"a\"" + repeated(".'a'", deep) + " = 1\n"), long_key);
    EXPECT_THAT(refusal("a = \"\"\"\n\\\"\"\"\"\"\"\n" + key), long_key) << "behind a string that ends with quotes";
    EXPECT_THAT(refusal("a = '''\n\\'''''\n" + key), long_key);
    const auto brackets = AllOf(StartsWith("my.toml:2: found more than 16 brackets"), HasSubstr("at most 16"));
    EXPECT_THAT(refusal("[rectify]\nregion = " + repeated("[", deep)), brackets);
    EXPECT_THAT(refusal("[rectify]\nregion = " + repeated("{a.a.a = ", deep)), brackets);
    EXPECT_THAT(refusal("", {daemon::parse_override("match.disparities=" + repeated("[", deep))}),
                AllOf(StartsWith("--set match.disparities=["), HasSubstr("allowed: ")));
    EXPECT_THAT(refusal("", {daemon::parse_override("match.disparities=1\n" + key)}),
                AllOf(StartsWith("--set match.disparities=1"), HasSubstr("allowed: ")));
}

TEST(Config, DotsAndBracketsOfTextAreNoDepth) {
    const std::string dots = repeated("..[{", 25);
    const std::string text = "# " + dots + "\n[source]\nuri = \"" + dots + "\\\"" + dots + "\" # " + dots +
                             "\n[record]\ndirectory = '" + dots + "'\n[socket]\nunix = '''\n" + dots + "'''\n";
    const daemon::Config config =
        daemon::parse_config(text, "my.toml", {daemon::parse_override("source.calibration=" + dots)});
    EXPECT_EQ(config.source.uri, dots + '"' + dots);
    EXPECT_EQ(config.record.directory, dots);
    EXPECT_EQ(config.socket.unix_path, dots);
    EXPECT_EQ(config.source.calibration, dots);
}

TEST(Config, MissingFileIsNamed) {
    try {
        daemon::load_config("/nowhere/disparityd.toml", {});
        FAIL() << "accepted";
    } catch (const std::invalid_argument& error) {
        EXPECT_THAT(error.what(), AllOf(HasSubstr("/nowhere/disparityd.toml"), HasSubstr("no such file")));
    }
    EXPECT_THROW(daemon::load_config("/tmp", {}), std::invalid_argument);
}

TEST(Config, TooManyOpenFilesAreNotToldAsAWrongPath) {
    const capture::test::OpenFilesLimit none;
    try {
        daemon::load_config(DISPARITYD_EXAMPLE_CONFIG, {});
        FAIL() << "accepted";
    } catch (const std::invalid_argument& error) {
        EXPECT_THAT(error.what(), AllOf(HasSubstr("this program has too many files open"),
                                        testing::Not(HasSubstr("check the path"))));
    }
}

// Reading them might never end.
TEST(Config, PipesAndDevicesAreRefused) {
    const std::string pipe = testing::TempDir() + "config-pipe-" + std::to_string(getpid());
    ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
    for (const std::string& path : {pipe, std::string("/dev/zero")}) {
        try {
            daemon::load_config(path, {});
            FAIL() << "accepted";
        } catch (const std::invalid_argument& error) {
            EXPECT_THAT(error.what(), StartsWith("configuration " + path + ": not a file, but "));
        }
    }
    unlink(pipe.c_str());
}

TEST(Config, UnixPathFollowsTheEnvironment) {
    daemon::Config config;
    config.socket.unix_path = "/x/y.sock";
    EXPECT_EQ(daemon::resolved_unix_path(config), "/x/y.sock");
    config.socket.unix_path = "auto";
    setenv("RUNTIME_DIRECTORY", "/tmp:/other", 1);
    EXPECT_EQ(daemon::resolved_unix_path(config), "/tmp/disparityd.sock");
    config.shared_memory.name = "left";
    EXPECT_EQ(daemon::resolved_unix_path(config), "/tmp/disparityd-left.sock");
    unsetenv("RUNTIME_DIRECTORY");
    setenv("STATE_DIRECTORY", "/var/lib/x", 1);
    EXPECT_EQ(daemon::resolved_record_directory(config).path, "/var/lib/x");
    EXPECT_TRUE(daemon::resolved_record_directory(config).chosen);
    unsetenv("STATE_DIRECTORY");
    config.record.directory = "/rec";
    EXPECT_EQ(daemon::resolved_record_directory(config).path, "/rec");
    EXPECT_TRUE(daemon::resolved_record_directory(config).chosen);
}

}  // namespace
}  // namespace disparityd
