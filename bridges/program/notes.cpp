// SPDX-License-Identifier: Apache-2.0
#include "bridges/program/notes.h"

#include <cctype>

namespace disparityd::bridges {
namespace {

std::string without_digits(std::string line) {
    std::erase_if(line, [](unsigned char character) { return std::isdigit(character) != 0; });
    return line;
}

}  // namespace

void Notes::say(const std::string& topic, const std::string& line, Repeat repeat, Clock::time_point now) {
    const auto last = said_.find(topic);
    if (last != said_.end()) {
        const bool same = without_digits(last->second.line) == without_digits(line);
        const auto pause = same ? std::chrono::seconds(60) : std::chrono::seconds(1);
        if ((same && repeat == Repeat::never) || now - last->second.when < pause) {
            return;
        }
    }
    write_(line);
    said_[topic] = {line, now};
}

}  // namespace disparityd::bridges
