// SPDX-License-Identifier: Apache-2.0
#include "tools/ctl/processing/resume.h"

#include <cstdint>
#include <stdexcept>

#include "base/file_kind.h"
#include "base/version.h"
#include "tools/command_line/program.h"
#include "tools/ctl/processing/begun_run.h"
#include "tools/ctl/processing/digest.h"
#include "tools/ctl/processing/manifest.h"
#include "tools/ctl/processing/process_source.h"
#include "tools/ctl/source_arguments.h"

namespace disparityd::tools {
namespace {

void check_same(const std::string& folder, const Json& made, const Json& now) {
    if (const std::string other = difference(made, now, "now"); !other.empty()) {
        refuse_made_with(folder, other);
    }
}

/// Compares what the sources of all parts say of themselves.
void check_parts(const ProcessArguments& arguments, const Json& manifest) {
    Json before = Json::array(), now = Json::array();
    for (const Json& part : manifest["parts"]) {
        before.push_back(part.at("source"));
    }
    for (const capture::SourceInfo& info : infos_of(arguments)) {
        now.push_back(to_json(info));
    }
    check_same(arguments.folder, {{"parts", before.size()}}, {{"parts", now.size()}});
    for (std::size_t i = 0; i < now.size(); ++i) {
        check_same(arguments.folder, {{"source", before[i]}}, {{"source", now[i]}});
    }
}

}  // namespace

std::optional<ProcessDone> finished_before(const ProcessArguments& arguments) {
    const std::string& folder = arguments.folder;
    if (!begun_with(folder)) {
        return std::nullopt;
    }
    const MatchOptions options = match_options(arguments);
    const Json parameters = parameters_of(arguments, options, scan_options_of(arguments, options));
    if (!base::is_file(folder + '/' + manifest_name)) {
        check_begun_with(folder, parameters);
        return std::nullopt;
    }
    ProcessDone done;
    done.source = arguments.source;
    done.folder = folder;
    done.before = true;
    Json manifest;
    try {
        manifest = read_manifest(folder, [&](const Json&) { ++done.frames; });
    } catch (const DamagedManifest& error) {
        check_begun_with(folder, parameters);
        print_note(std::string(error.what()) + "; " + arguments.source + " is processed again");
        return std::nullopt;
    }
    check_same(folder, {{"version", manifest["made_by"]}, {"parameters", manifest["parameters"]}},
               {{"version", base::version_line("disparityctl")}, {"parameters", parameters}});
    if (is_kept(arguments.source)) {
        check_parts(arguments, manifest);
    }
    if (const std::string lack = lack_of(folder, arguments.scan); !lack.empty()) {
        print_note(lack + "; " + arguments.source + " is processed again");
        return std::nullopt;
    }
    if (base::is_file(arguments.scan) && manifest.value("scan_sha256", Json()) != sha256_of_file(arguments.scan)) {
        throw std::invalid_argument(arguments.scan + ": is not the file that was written with " + folder +
                                    "; move it away to have it made again, or replace all with --force");
    }
    done.damaged = manifest["losses"].at("damaged").get<std::uint64_t>();
    return done;
}

}  // namespace disparityd::tools
