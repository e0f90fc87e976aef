// SPDX-License-Identifier: Apache-2.0
#include "tools/ctl/mcap/mcap_report.h"

#include <iostream>
#include <utility>

#include "base/message_text.h"
#include "base/words.h"
#include "clients/json/message_json.h"
#include "tools/command_line/interrupt.h"
#include "tools/command_line/program.h"
#include "tools/command_line/table.h"

namespace disparityd::tools {
namespace {

json::Json to_json(const McapReport& report) {
    json::Json topics = json::Json::object();
    for (const auto& [topic, messages] : report.topics) {
        topics[topic] = messages;
    }
    json::Json all{{"file", report.file}, {"frames", report.frames}, {"messages", report.messages}};
    for (const auto& [name, count] : {std::pair("dropped", &report.dropped),
                                      {"dropped_before", &report.dropped_before},
                                      {"dropped_samples", &report.dropped_samples},
                                      {"without_camera_info", &report.without_camera_info}}) {
        if (*count) {
            all[name] = **count;
        }
    }
    all["bytes"] = report.bytes;
    all["topics"] = std::move(topics);
    all["error"] = report.error;
    return all;
}

void print(const McapReport& report) {
    std::cout << report.file << ": " << base::counted(report.frames, "frame") << ", "
              << base::counted(report.messages, "message") << " on " << base::counted(report.topics.size(), "topic")
              << ", " << fixed(static_cast<double>(report.bytes) / 1e6, 1) << " MB";
    if (report.dropped) {
        std::cout << "; " << *report.dropped << " dropped";
    }
    if (report.dropped_samples.value_or(0) > 0) {
        std::cout << ", and " << base::counted(*report.dropped_samples, "sample") << " of the sensors";
    }
    if (report.dropped_before.value_or(0) > 0) {
        // Frames that did not come here in time took with them what they told of those before.
        std::cout << "; " << (report.dropped.value_or(0) > 0 ? "at least " : "") << *report.dropped_before
                  << " more never came from the daemon, which dropped or lost them";
    }
    if (report.without_camera_info.value_or(0) > 0) {
        std::cout << "; " << base::counted(*report.without_camera_info, "raw pair")
                  << " without camera_info, as the daemon did not tell of that calibration in time";
    }
    std::cout << '\n';
}

}  // namespace

void McapReport::take(const std::optional<RosMcap>& written) {
    if (written) {
        frames = written->frames();
        messages = written->messages();
        bytes = written->bytes();
        topics = written->messages_of_topics();
    }
}

int McapReport::tell(bool as_json) const {
    if (as_json) {
        std::cout << json::to_text(to_json(*this), 2) << '\n';
    } else if (messages > 0) {
        print(*this);
    }
    if (!error.empty()) {
        print_error(error + (messages == 0 ? "; nothing was written" : "; what came before that is in " + file));
        return disk_full ? exit_again : exit_failed;
    }
    if (interrupted() && (!interruption_is_usual || messages == 0)) {
        print_note("stopped by " + interrupted_by() +
                   (messages == 0 ? "; nothing was written" : "; " + file + " has what came before"));
        return exit_interrupted;
    }
    if (messages == 0) {
        print_error("no frame came; nothing was written");
        return exit_failed;
    }
    return exit_done;
}

}  // namespace disparityd::tools
