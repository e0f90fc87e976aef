// SPDX-License-Identifier: Apache-2.0
#include "tools/ctl/processing/matching_options.h"

#include <string>

#include <CLI/CLI.hpp>

#include "tools/command_line/match_arguments.h"
#include "tools/command_line/number_argument.h"
#include "tools/ctl/source_arguments.h"

namespace disparityd::tools {

void add_matching_options(CLI::App& command, ProcessArguments& arguments) {
    command.add_option("--method", arguments.method, method_help() + "; default sgm")->type_name("METHOD");
    command.add_option("--backend", arguments.backend, backend_help())->type_name("NAME");
    command.add_option("--calibration", arguments.calibration, "calibration instead of the source's own")
        ->type_name("FILE");
    command.add_option("--size", arguments.size, "size of the rectified image; default: that of the capture")
        ->type_name("WxH");
    command.add_option("--region", arguments.region, "part of the rectified image to match; default: all of it")
        ->type_name("X,Y,W,H");
    add_integer(command, "--frames", arguments.frames, 1, 1'000'000'000, "stop after this many frames");
    add_time_offset(command, arguments.time_offset_us);
    add_integer(command, "--workers", arguments.workers, 0, 256, "worker threads; default 0: one per core");
    command.add_flag("--no-trust", arguments.no_trust,
                     "do not judge how far frames can be trusted, which depends on the frames before");
    command.add_flag("--temporal", arguments.temporal,
                     "make a mean over time of disparities that agree, as [temporal] of the daemon does");
    CLI::Option& self_calibrate =
        *command.add_flag("--self-calibrate", arguments.self_calibrate,
                          "estimate corrections of the calibration from the frames, four times in every 80 frames");
    command
        .add_flag("--no-self-calibration", arguments.no_self_calibration,
                  "do not apply the corrections that a recording holds")
        ->excludes(&self_calibrate);
    command
        .add_option("--mask-polygon", arguments.mask_polygons,
                    "reject what lies in a polygon of the rectified left image; may be given several times")
        ->allow_extra_args(false)
        ->type_name("\"X,Y X,Y X,Y\"");
    command.add_option("--mask-image", arguments.mask_image, "reject where a grey image of that size is black")
        ->type_name("FILE");
    arguments.distances.add_to(command);
    // The daemon's default: the same bytes as from it.
    arguments.match.add_to(
        command,
        "default " + std::to_string(ProcessArguments::default_disparities) + ", or what a dataset's files ask for",
        Preset::obstacles);
}

}  // namespace disparityd::tools
