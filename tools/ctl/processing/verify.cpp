// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <memory>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "base/file_kind.h"
#include "base/words.h"
#include "tools/command_line/program.h"
#include "tools/ctl/commands.h"
#include "tools/ctl/processing/digest.h"
#include "tools/ctl/processing/manifest.h"
#include "tools/ctl/processing/shards/split_source.h"
#include "tools/ctl/processing/times_csv.h"
#include "tools/images/disparity_file.h"
#include "tools/images/image_file.h"

namespace disparityd::tools {
namespace {

namespace fs = std::filesystem;

/// What was found; each problem is a line on stdout.
struct Findings {
    std::uint64_t frames = 0;
    std::uint64_t problems = 0;

    void tell(const std::string& what, const std::string& problem) {
        ++problems;
        std::cout << what << ": " << problem << '\n';
    }
};

/// Returns the folders of sources by their names in `folder`; "" is the folder itself.
std::map<std::string, std::string> sources_in(const std::string& folder) {
    if (base::is_file(folder + '/' + manifest_name) || !ranges_in(folder).empty()) {
        return {{"", folder}};
    }
    std::map<std::string, std::string> sources;
    std::error_code error;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
        if (base::is_folder(entry.path())) {
            sources.emplace(entry.path().filename().string(), entry.path().string());
        }
    }
    const bool any = std::any_of(sources.begin(), sources.end(), [](const auto& source) {
        return base::is_file(source.second + '/' + manifest_name) || !ranges_in(source.second).empty();
    });
    if (!any) {
        throw std::invalid_argument(folder + ": there is no " + manifest_name +
                                    " in it, nor in a folder in it: disparityctl process writes it when a source is "
                                    "finished");
    }
    return sources;
}

/// Returns the SHA-256 that the manifest has of such a file.
std::string digest_of(const std::string& path) {
    if (path.ends_with(geometry_name)) {
        std::ifstream file(path);
        return sha256_of_geometry(Json::parse(file));
    }
    if (path.ends_with(".png")) {
        return sha256(images::read_image(path));
    }
    return path.ends_with(".pfm") ? sha256(images::read_disparity_pfm(path)) : sha256_of_file(path);
}

void check_files(const std::string& folder, const Json& digests, std::set<std::string>& known, Findings& found) {
    for (const auto& [name, digest] : digests.items()) {
        const std::string path = folder + '/' + name;
        known.insert(name);
        if (!base::is_file(path)) {
            found.tell(path, "missing");
            continue;
        }
        try {
            if (digest != digest_of(path)) {
                found.tell(path, "changed");
            }
        } catch (const std::exception& error) {
            found.tell(path, "changed: " + std::string(error.what()));
        }
    }
}

void tell_extra(const std::string& folder, const std::set<std::string>& known, Findings& found) {
    std::set<std::string> extra;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
        const std::string name = entry.path().filename().string();
        if (!known.contains(name)) {
            extra.insert(name);
        }
    }
    for (const std::string& name : extra) {
        found.tell(folder + '/' + name, "extra");
    }
}

/// times.csv beside the manifest: but for how long each step took, both tell the same.
class TimesFile {
public:
    explicit TimesFile(const std::string& folder) : path_(folder + '/' + times_name), file_(path_) {
        expect(times_head());
    }

    void expect_frame(const Json& frame) { expect(times_columns(lines_ - 1, frame)); }

    void tell(Findings& found) {
        std::string more;
        if (!base::is_file(path_)) {
            found.tell(path_, "missing");
        } else if (changed_ > 0) {
            found.tell(path_, "changed: line " + std::to_string(changed_));
        } else if (std::getline(file_, more)) {
            found.tell(path_, "changed: has more lines than there are frames");
        }
    }

private:
    void expect(const std::string& begin) {
        ++lines_;
        std::string line;
        std::getline(file_, line);
        // As in the manifest, where names are UTF-8.
        if (changed_ == 0 && !Json::parse(to_text(line, -1)).get<std::string>().starts_with(begin)) {
            changed_ = lines_;
        }
    }

    std::string path_;
    std::ifstream file_;
    std::uint64_t lines_ = 0;    ///< that were compared
    std::uint64_t changed_ = 0;  ///< the first of them, from 1; 0: none
};

/// Tells what of the source is in no frame; it is no change of what was written. Images that are left out are missing
/// in between, too, but for the last ones.
void tell_losses(const std::string& folder, const Json& losses) {
    std::string line;
    const auto add = [&line](std::uint64_t count, const char* what) {
        if (count > 0) {
            line.append(line.empty() ? "" : ", ").append(base::counted(count, "frame")).append(what);
        }
    };
    add(losses.at("left_out").size(), " left out");
    add(losses.at("damaged").get<std::uint64_t>(), " marked as damaged");
    add(losses.at("lost").get<std::uint64_t>(), " missing in between");
    if (!line.empty()) {
        std::cout << folder << ": not in it: " << line << '\n';
    }
}

/// Returns what there is of ranges instead; empty: nothing.
std::string text_of_ranges(const std::string& folder) {
    const std::vector<Shard> ranges = ranges_in(folder);
    if (ranges.empty()) {
        return {};
    }
    const std::vector<std::string> folders = range_folders_in(folder);
    const auto finished = std::count_if(folders.begin(), folders.end(), [](const std::string& range) {
        return base::is_file(range + '/' + manifest_name);
    });
    return ", but " + std::to_string(finished) + " of " + std::to_string(ranges.front().count) +
           " ranges of --split; process --resume joins them when all are finished";
}

void verify_source(const std::string& folder, Findings& found) {
    if (!base::is_file(folder + '/' + manifest_name)) {
        found.tell(folder, "not finished: there is no manifest.json" + text_of_ranges(folder));
        return;
    }
    std::set<std::string> known{manifest_name, times_name};
    TimesFile times(folder);
    try {
        const Json manifest = read_manifest(folder, [&](const Json& frame) {
            ++found.frames;
            times.expect_frame(frame);
            check_files(folder, frame.at("sha256"), known, found);
        });
        check_files(folder, manifest["files"], known, found);
        tell_losses(folder, manifest["losses"]);
    } catch (const DamagedManifest& error) {
        found.tell(folder, error.what() + std::string("; process --resume does the source again"));
        return;
    } catch (const std::invalid_argument& error) {
        found.tell(folder, error.what());
        return;
    }
    times.tell(found);
    tell_extra(folder, known, found);
}

/// A manifest without what depends on where the source lies.
struct Comparable {
    Json facts;
    Json input;  ///< SHA-256 of all bytes; null: not told
    std::vector<Json> frames;
    std::string made_by;
};

Comparable comparable(const std::string& folder) {
    Comparable manifest;
    Json all = read_manifest(folder, [&manifest](Json frame) {
        frame.erase("input");
        manifest.frames.push_back(std::move(frame));
    });
    manifest.made_by = all["made_by"].get<std::string>();
    manifest.input = all.value("input_sha256", Json());
    all["parameters"].erase("input");
    all["parameters"].erase("scan_file");
    Json rectified = Json::array();
    for (const Json& part : all["parts"]) {
        rectified.push_back({{"from_frame", part.at("from_frame")},
                             {"rectified", part.at("rectified")},
                             {"maps_sha256", part.value("maps_sha256", Json())}});
    }
    Json files = all["files"];
    files.erase(geometry_name);  // names the source's place; what it says otherwise is compared above
    manifest.facts = {{"parameters", all["parameters"]}, {"parts", rectified}, {"files", files}};
    manifest.facts["frames"] = manifest.frames.size();
    manifest.facts["lost"] = all["losses"].at("lost");
    manifest.facts["left_out"] = all["losses"].at("left_out").size();
    manifest.facts["damaged"] = all["losses"].at("damaged");
    return manifest;
}

void compare(const std::string& name, const std::string& folder, const std::string& other, Findings& found) {
    const Comparable one = comparable(folder), two = comparable(other);
    if (one.made_by != two.made_by) {
        print_note(name + ": made by " + one.made_by + ", there by " + two.made_by);
    }
    for (const auto& [key, value] : one.facts.items()) {
        const Json here{{key, value}}, there{{key, two.facts.at(key)}};
        if (const std::string facts = difference(here, there, "there"); !facts.empty()) {
            found.tell(name, facts);
        }
    }
    if (!one.input.is_null() && !two.input.is_null() && one.input != two.input) {
        found.tell(name, difference({{"input_sha256", one.input}}, {{"input_sha256", two.input}}, "there"));
    }
    for (std::size_t i = 0; i < std::min(one.frames.size(), two.frames.size()); ++i) {
        if (const std::string frame = difference(one.frames[i], two.frames[i], "there"); !frame.empty()) {
            found.tell(name, "frame " + std::to_string(i) + ": " + frame);
        }
    }
}

void compare_all(const std::string& folder, const std::string& other, Findings& found) {
    const auto here = sources_in(folder), there = sources_in(other);
    for (const auto& [name, path] : here) {
        const auto same = there.find(name);
        if (same == there.end() || !base::is_file(same->second + '/' + manifest_name)) {
            found.tell(path, "not finished in " + other);
        } else if (base::is_file(path + '/' + manifest_name)) {
            compare(path, path, same->second, found);
        }
    }
    for (const auto& [name, path] : there) {
        if (!here.contains(name)) {
            found.tell(path, "not in " + folder);
        }
    }
}

int verify(const std::string& folder, const std::string& other) {
    Findings found;
    const auto sources = sources_in(folder);
    for (const auto& [name, path] : sources) {
        verify_source(path, found);
    }
    if (!sources.contains("")) {
        std::set<std::string> names;
        for (const auto& [name, path] : sources) {
            names.insert(name);
        }
        tell_extra(folder, names, found);
    }
    if (!other.empty()) {
        compare_all(folder, other, found);
    }
    std::cout << folder << ": " << base::counted(sources.size(), "source") << ", "
              << base::counted(found.frames, "frame") << ": "
              << (found.problems > 0 ? base::counted(found.problems, "problem")
                  : other.empty()    ? "all is as the manifest says"
                                     : "all is as the manifest says, and as in " + other)
              << '\n';
    return found.problems > 0 ? exit_failed : exit_done;
}

}  // namespace

void add_verify(CLI::App& program, Action& action) {
    CLI::App& command = *program.add_subcommand(
        "verify", "Check what process has written against its manifests, or compare two folders.");
    const auto folder = std::make_shared<std::string>();
    const auto other = std::make_shared<std::string>();
    command.add_option("DIR", *folder, "what process has filled, with one source or several")->required();
    command.add_option("--against", *other, "another folder, whose manifests must tell the same")->type_name("DIR");
    command.footer(
        "Every file that is missing, changed or extra is a line, exit status 1. Pictures are decoded: how they are\n"
        "compressed does not matter. The times of steps in times.csv are not compared. Frames that the source lost "
        "are\n"
        "told. --against compares parameters, geometry, frames and their SHA-256, but not where the sources lie; it\n"
        "reads the manifests of the other folder, not its files. It alone sees that the folder of a source is gone.\n"
        "Examples: disparityctl verify out\n"
        "          disparityctl verify out --against /mnt/other/out");
    command.callback([folder, other, &action] { action = [folder, other] { return verify(*folder, *other); }; });
}

}  // namespace disparityd::tools
