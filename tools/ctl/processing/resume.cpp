// SPDX-License-Identifier: Apache-2.0
#include "tools/ctl/processing/resume.h"

#include <filesystem>
#include <stdexcept>

#include "base/file_kind.h"
#include "base/version.h"
#include "base/words.h"
#include "tools/command_line/program.h"
#include "tools/ctl/processing/manifest.h"
#include "tools/ctl/processing/process_source.h"
#include "tools/ctl/source_arguments.h"

namespace disparityd::tools {
namespace {

namespace fs = std::filesystem;

/// What lost power in the middle may have its name and no content.
bool has_content(const std::string& path) {
    std::error_code error;
    return fs::file_size(path, error) > 0 && !error;
}

[[noreturn]] void refuse(const std::string& folder, const std::string& difference) {
    throw std::invalid_argument(folder + ": was made with " + difference +
                                "; repeat what it was made with, choose another folder, or replace all with --force");
}

/// Says why an earlier run is not done, and takes its manifest away.
std::nullopt_t begin_anew(const ProcessArguments& arguments, const std::string& reason) {
    print_note(reason + "; " + arguments.source + " is processed again");
    fs::remove(arguments.folder + '/' + manifest_name);
    return std::nullopt;
}

}  // namespace

std::optional<ProcessDone> finished_before(const ProcessArguments& arguments) {
    const std::string& folder = arguments.folder;
    if (!base::is_file(folder + '/' + manifest_name)) {
        return std::nullopt;
    }
    ProcessDone done;
    done.source = arguments.source;
    done.folder = folder;
    done.before = true;
    std::string missing = arguments.scan.empty() || base::is_file(arguments.scan) ? "" : arguments.scan;
    const auto look_for = [&](const Json& files) {
        for (const auto& [name, digest] : files.items()) {
            if (missing.empty() && !has_content(folder + '/' + name)) {
                missing = folder + '/' + name;
            }
        }
    };
    Json manifest;
    try {
        manifest = read_manifest(folder, [&](const Json& frame) {
            ++done.frames;
            look_for(frame.at("sha256"));
        });
    } catch (const DamagedManifest& error) {
        return begin_anew(arguments, error.what());
    }
    look_for(manifest["files"]);
    const MatchOptions options = match_options(arguments);
    const Json made{{"version", manifest["made_by"]}, {"parameters", manifest["parameters"]}};
    const Json now{{"version", base::version_line("disparityctl")},
                   {"parameters", parameters_of(arguments, options, scan_options_of(arguments, options))}};
    if (const std::string other = difference(made, now, "now"); !other.empty()) {
        refuse(folder, other);
    }
    if (is_kept(arguments.source)) {
        const Json source{{"source", to_json(info_of(arguments))}};
        const Json before{{"source", manifest["parts"].at(0).at("source")}};
        if (const std::string other = difference(before, source, "now"); !other.empty()) {
            refuse(folder, other);
        }
    }
    if (!missing.empty()) {
        return begin_anew(arguments, missing + ": is missing or empty");
    }
    const Json& losses = manifest["losses"];
    // What kept them from being read may have passed, such as a share that was gone.
    if (const std::size_t left_out = losses.at("left_out").size(); left_out > 0) {
        return begin_anew(arguments, folder + ": " + base::counted(left_out, "frame") + " left out before");
    }
    done.damaged = losses.at("damaged").get<std::uint64_t>();
    return done;
}

}  // namespace disparityd::tools
