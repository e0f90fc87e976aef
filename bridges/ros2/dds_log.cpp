// SPDX-License-Identifier: Apache-2.0
#include "bridges/ros2/dds_log.h"

#include <string>
#include <utility>

namespace disparityd::ros2 {

DdsLog::DdsLog(bridges::Notes::Write write) : write_(std::move(write)), fading_(write_) {
    dds_set_log_sink(take, this);
}

DdsLog::~DdsLog() {
    dds_set_log_sink(nullptr, nullptr);
}

void DdsLog::calm() {
    const std::lock_guard lock(mutex_);
    calm_ = true;
}

void DdsLog::take(void* self, const dds_log_data_t* data) {
    DdsLog& log = *static_cast<DdsLog*>(self);
    const std::string line = "DDS: " + std::string(data->message, data->size);
    const std::lock_guard lock(log.mutex_);
    if (log.calm_) {
        log.fading_.say(line, FadingLines::Clock::now());
    } else {
        log.write_(line);
    }
}

}  // namespace disparityd::ros2
