// SPDX-License-Identifier: Apache-2.0
#include "bridges/mavlink/notes.h"

namespace disparityd::mavlink {

void Notes::say(const std::string& topic, const std::string& line, Repeat repeat, Clock::time_point now) {
    const auto last = said_.find(topic);
    if (last != said_.end()) {
        const bool same = last->second.line == line;
        const auto pause = same ? std::chrono::seconds(60) : std::chrono::seconds(1);
        if ((same && repeat == Repeat::never) || now - last->second.when < pause) {
            return;
        }
    }
    write_(line);
    said_[topic] = {line, now};
}

}  // namespace disparityd::mavlink
