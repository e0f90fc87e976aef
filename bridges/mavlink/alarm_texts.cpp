// SPDX-License-Identifier: Apache-2.0
#include "bridges/mavlink/alarm_texts.h"

#include <string>

namespace disparityd::mavlink {

Message status_text(Severity severity, std::string_view text) {
    constexpr std::size_t room = 50;
    Message message{status_text_kind, {}};
    PayloadWriter writer(message.payload);
    writer.u8(static_cast<std::uint8_t>(severity));
    for (std::size_t i = 0; i < room; ++i) {
        writer.u8(i < text.size() ? static_cast<std::uint8_t>(text[i]) : std::uint8_t{0});
    }
    writer.u16(0).u8(0);  // id and chunk_seq: a text of one part
    return message;
}

void AlarmTexts::tell(std::uint32_t flags, Clock::time_point now, const std::function<bool(const Message&)>& send) {
    for (std::size_t i = 0; i < told_.size(); ++i) {
        const proto::DoubtFacts& doubt = proto::doubts[i];
        const bool holds = doubt.alarm && (flags & doubt.bit) != 0;
        Told& told = told_[i];
        const bool early = told.when != Clock::time_point() && now - told.when < pause;
        if (holds == told.holds || early) {
            continue;
        }
        const std::string text = "stereo camera: " + std::string(doubt.name) + (holds ? "" : " is over");
        if (send(status_text(holds ? Severity::warning : Severity::info, text))) {
            told = {holds, now};
        }
    }
}

}  // namespace disparityd::mavlink
