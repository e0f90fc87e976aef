// SPDX-License-Identifier: Apache-2.0
#include "tools/ctl/processing/resume.h"

#include <cstdint>
#include <stdexcept>

#include "base/file_kind.h"
#include "base/version.h"
#include "tools/command_line/interrupt.h"
#include "tools/command_line/program.h"
#include "tools/ctl/processing/begun_run.h"
#include "tools/ctl/processing/digest.h"
#include "tools/ctl/processing/input_files.h"
#include "tools/ctl/processing/manifest.h"
#include "tools/ctl/processing/process_source.h"
#include "tools/ctl/source_arguments.h"

namespace disparityd::tools {
namespace {

/// Compares what the sources of all parts say of themselves.
void check_parts(const ProcessArguments& arguments, const Json& manifest) {
    Json before = Json::array(), now = Json::array();
    for (const Json& part : manifest["parts"]) {
        before.push_back(part.at("source"));
    }
    for (const capture::SourceInfo& info : infos_of(arguments)) {
        now.push_back(to_json(info));
    }
    check_made_with(arguments.folder, {{"parts", before.size()}}, {{"parts", now.size()}});
    for (std::size_t i = 0; i < now.size(); ++i) {
        check_made_with(arguments.folder, {{"source", before[i]}}, {{"source", now[i]}});
    }
}

}  // namespace

std::optional<ProcessDone> finished_before(const ProcessArguments& arguments) {
    const std::string& folder = arguments.folder;
    if (!begun_with(folder)) {
        return std::nullopt;
    }
    const MatchOptions options = match_options(arguments, Notes::none);
    const Json parameters = parameters_of(arguments, options, scan_options_of(arguments, options));
    if (!base::is_file(folder + '/' + manifest_name)) {
        check_begun_with(folder, parameters);
        return std::nullopt;
    }
    MadeRun made;
    try {
        made = made_run(folder, arguments.scan, whole_of(arguments));
    } catch (const DamagedManifest& error) {
        check_begun_with(folder, parameters);
        print_note(std::string(error.what()) + "; " + arguments.source + " is processed again");
        return std::nullopt;
    }
    const Json& manifest = made.manifest;
    check_made_with(folder, {{"version", manifest.at("made_by")}, {"parameters", manifest.at("parameters")}},
                    {{"version", base::version_line("disparityctl")}, {"parameters", parameters}});
    // The files of any other source say all of it, and `listing` says that they are the same.
    if (is_calibrated_elsewhere(arguments.source) && arguments.calibration.empty()) {
        check_parts(arguments, manifest);
    }
    if (!made.lack.empty()) {
        print_note(made.lack + "; " + arguments.source + " is processed again");
        return std::nullopt;
    }
    if (base::is_file(arguments.scan) && manifest.value("scan_sha256", Json()) != sha256_of_file(arguments.scan)) {
        throw std::invalid_argument(arguments.scan + ": is not the file that was written with " + folder +
                                    "; move it away to have it made again, or replace all with --force");
    }
    if (const Json before = manifest.value("input_sha256", Json()); arguments.hash_inputs && !before.is_null()) {
        const Json now = content_of_input(arguments.source, interrupted);
        if (!interrupted()) {
            check_made_with(folder, {{"input_sha256", before}}, {{"input_sha256", now}});
        }
    }
    ProcessDone done;
    done.source = arguments.source;
    done.folder = folder;
    done.before = true;
    done.frames = made.frames;
    done.damaged = manifest.at("losses").at("damaged").get<std::uint64_t>();
    return done;
}

}  // namespace disparityd::tools
