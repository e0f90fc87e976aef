// SPDX-License-Identifier: Apache-2.0
#include "tools/ctl/processing/earlier_run.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <set>
#include <stdexcept>
#include <string_view>
#include <vector>

#include "base/failure_text.h"
#include "tools/command_line/csv.h"
#include "tools/ctl/growing_file.h"
#include "tools/ctl/processing/begun_run.h"
#include "tools/ctl/processing/manifest.h"
#include "tools/ctl/processing/more_outputs.h"
#include "tools/ctl/processing/shards/split_source.h"
#include "tools/ctl/processing/times_csv.h"

namespace disparityd::tools {
namespace {

namespace fs = std::filesystem;

/// Of the files of a frame.
constexpr std::string_view frame_endings[] = {".png", ".pfm", ".ply", ".pcd"};

/// Returns the names that an earlier run gave its frames, from its times.csv.
std::set<std::string> names_of_earlier_run(const fs::path& folder) {
    std::set<std::string> names;
    const fs::path whole = folder / times_name;
    std::ifstream times(fs::exists(whole) ? whole.string() : GrowingFile::part_of(whole));
    std::string line;
    std::getline(times, line);
    const std::vector<std::string> head = csv_fields(line);
    const auto column = static_cast<std::size_t>(std::find(head.begin(), head.end(), "output") - head.begin());
    while (column < head.size() && std::getline(times, line)) {
        const std::vector<std::string> fields = csv_fields(line);
        if (column < fields.size()) {
            names.insert(fields[column]);
        }
    }
    return names;
}

/// Whether it is calib.txt or, of the part from frame 12 on, calib-12.txt.
bool is_calibration(std::string_view name) {
    constexpr std::string_view begin = "calib", end = ".txt";
    if (!name.starts_with(begin) || !name.ends_with(end)) {
        return false;
    }
    name = name.substr(begin.size(), name.size() - begin.size() - end.size());
    return name.empty() ||
           (name.size() > 1 && name[0] == '-' && name.find_first_not_of("0123456789", 1) == std::string_view::npos);
}

/// Whether the earlier run made such a file: one of `names` with an ending, or a list.
bool is_ours(const std::string& name, const std::set<std::string>& names) {
    if (name == corrections_name) {
        return true;
    }
    const auto ends = [&](std::string_view ending) {
        return std::string_view(name).ends_with(ending) && names.contains(name.substr(0, name.size() - ending.size()));
    };
    return std::any_of(std::begin(output_suffixes), std::end(output_suffixes),
                       [&](std::string_view suffix) { return ends(std::string(suffix) + ".png"); }) ||
           std::any_of(std::begin(frame_endings), std::end(frame_endings), ends) || is_calibration(name);
}

/// Whether it is what a killed process was writing: ".NAME.part" or ".NAME.PROCESS".
bool is_left_over(const std::string& name) {
    const std::string_view text = name;
    if (!text.starts_with('.')) {
        return false;
    }
    const auto is_written = [](std::string_view file) {
        return std::any_of(std::begin(frame_endings), std::end(frame_endings),
                           [&](std::string_view ending) { return file.ends_with(ending); }) ||
               file == geometry_name || is_calibration(file);
    };
    const std::size_t dot = text.rfind('.');
    const bool number = std::all_of(text.begin() + static_cast<std::ptrdiff_t>(dot) + 1, text.end(),
                                    [](unsigned char c) { return std::isdigit(c) != 0; });
    return text.ends_with(".csv.part") || text == GrowingFile::part_of(manifest_name) ||
           (dot > 0 && number && is_written(text.substr(1, dot - 1)));
}

[[noreturn]] void refuse(const std::string& folder, const std::error_code& error) {
    throw std::runtime_error(folder + ": " + base::error_text(error.value()));
}

/// Whether the file is a geometry.json of this program: others may have files of that name.
bool is_geometry(const fs::path& path) {
    std::ifstream file(path);
    const Json geometry = Json::parse(file, nullptr, false);
    return geometry.is_object() && geometry.contains("match") && geometry.contains("files");
}

}  // namespace

void remove_earlier_run(const std::string& folder) {
    const std::set<std::string> names = names_of_earlier_run(folder);
    std::error_code error;
    // What is half removed must not look finished, and must still tell what it was begun with, and its names: all that
    // tells this goes last.
    const fs::path manifest = fs::path(folder) / manifest_name, begun = GrowingFile::part_of(manifest);
    const fs::path times = fs::path(folder) / times_name, times_begun = GrowingFile::part_of(times);
    if (fs::exists(manifest)) {
        fs::rename(manifest, begun, error);
    }
    std::vector<fs::path> earlier;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
        const std::string name = entry.path().filename().string();
        if (entry.path() != begun && entry.path() != times_begun && (is_ours(name, names) || is_left_over(name))) {
            earlier.push_back(entry.path());
        }
    }
    earlier.insert(earlier.end(), {times, times_begun, fs::path(folder) / geometry_name, begun});
    for (const fs::path& path : earlier) {
        if (!error) {
            fs::remove(path, error);
        }
    }
    if (error) {
        refuse(folder, error);
    }
}

void remove_half_written(const std::string& folder) {
    std::vector<fs::path> half_written;
    std::error_code error;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
        const std::string name = entry.path().filename().string();
        if (is_left_over(name) && name != GrowingFile::part_of(manifest_name)) {
            half_written.push_back(entry.path());
        }
    }
    for (const fs::path& path : half_written) {
        if (!error) {
            fs::remove(path, error);
        }
    }
    if (error) {
        refuse(folder, error);
    }
}

FolderContent content_of(const fs::path& folder) {
    FolderContent content;
    std::error_code error;
    content.known = begun_with(folder.string()).has_value();
    content.begun = content.known || is_geometry(folder / geometry_name);
    content.finished = fs::exists(folder / manifest_name, error);
    for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
        const std::string name = entry.path().filename().string();
        if (is_range(name)) {
            content.range = name;
        } else if (content.other.empty() && !is_left_over(name)) {
            content.other = name;
        }
    }
    return content;
}

void check_content(const std::string& folder, const FolderContent& found, Replacing replacing) {
    if (!found.range.empty()) {
        throw std::invalid_argument(folder + ": holds " + found.range +
                                    ", which --split has begun, allowed: to go on with --split and as many shards, or "
                                    "another folder");
    }
    if (!found.other.empty() && replacing == Replacing::unfinished && !found.known) {
        throw std::invalid_argument(
            folder + ": is not empty (found " + found.other +
            "), and no manifest tells what was begun in it, allowed with --resume: a new or empty folder, or one that "
            "an earlier run of this version has begun" +
            (found.begun ? "; --force replaces the earlier run" : ""));
    }
    // Other pictures may have such names, too, for example the input.
    if (!found.other.empty() && (replacing == Replacing::nothing || !found.begun)) {
        throw std::invalid_argument(
            folder + ": is not empty (found " + found.other + "), allowed: a new or empty folder" +
            (found.begun ? ", --resume to finish the earlier run in it, or --force to replace it" : ""));
    }
}

}  // namespace disparityd::tools
