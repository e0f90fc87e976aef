// SPDX-License-Identifier: Apache-2.0
#include "tools/ctl/processing/begun_run.h"

#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "base/words.h"
#include "tools/ctl/growing_file.h"
#include "tools/ctl/processing/manifest.h"

namespace disparityd::tools {
namespace {

/// What lost power in the middle may have its name and no content.
bool has_content(const std::string& path) {
    std::error_code error;
    return std::filesystem::file_size(path, error) > 0 && !error;
}

/// Returns the parameters of the first lines of a manifest, whether the rest is there or not.
std::optional<Json> parameters_in(const std::string& path) {
    constexpr int lines_of_head = 3;
    std::ifstream file(path);
    std::string head, line;
    for (int i = 0; i < lines_of_head && std::getline(file, line); ++i) {
        head += line;
    }
    if (!head.ends_with(',')) {
        return std::nullopt;
    }
    head.back() = '}';
    const Json members = Json::parse(head, nullptr, false);
    return members.is_object() && members.contains("parameters") ? std::optional(members["parameters"]) : std::nullopt;
}

}  // namespace

std::optional<Json> begun_with(const std::string& folder) {
    const std::string whole = folder + '/' + manifest_name;
    auto parameters = parameters_in(whole);
    return parameters ? parameters : parameters_in(GrowingFile::part_of(whole));
}

void check_made_with(const std::string& folder, const Json& made, const Json& now) {
    const std::string other = difference(made, now, "now");
    if (other.empty()) {
        return;
    }
    const bool input = other.starts_with("parameters.input.listing");
    throw std::invalid_argument(
        folder + ": was made with " +
        (input ? std::string("other input: names, sizes or times of change of its files differ now") : other) +
        "; repeat what it was made with, choose another folder, or replace all with --force");
}

void check_begun_with(const std::string& folder, const Json& parameters) {
    if (const auto before = begun_with(folder)) {
        check_made_with(folder, {{"parameters", *before}}, {{"parameters", parameters}});
    }
}

MadeRun made_run(const std::string& folder, const std::string& scan, const std::string& whole) {
    MadeRun run;
    std::error_code error;
    std::string missing = scan.empty() || std::filesystem::exists(scan, error) ? "" : scan;
    const auto look_for = [&](const Json& files) {
        for (const auto& [name, digest] : files.items()) {
            if (missing.empty() && !has_content(folder + '/' + name) &&
                (whole.empty() || !has_content(whole + '/' + name))) {
                missing = folder + '/' + name;
            }
        }
    };
    run.manifest = read_manifest(folder, [&](const Json& frame) {
        ++run.frames;
        look_for(frame.at("sha256"));
    });
    look_for(run.manifest["files"]);
    const std::size_t left_out = run.manifest["losses"].at("left_out").size();
    if (!missing.empty()) {
        run.lack = missing + ": is missing or empty";
    } else if (left_out > 0) {
        run.lack = folder + ": " + base::counted(left_out, "frame") + " left out before";
    }
    return run;
}

bool is_done(const std::string& folder, const std::string& scan, const std::string& whole) {
    try {
        return made_run(folder, scan, whole).lack.empty();
    } catch (const DamagedManifest&) {
        return false;
    }
}

}  // namespace disparityd::tools
