// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mutex>

#include <dds/ddsrt/log.h>

#include "bridges/program/notes.h"
#include "bridges/ros2/fading_lines.h"

namespace disparityd::ros2 {

/// Hands on what Cyclone DDS has to say, as lines. It warns of every packet that it does not understand, and anybody on
/// the network can send some: calm() keeps them from filling the journal. There is one at a time; it outlives nodes.
class DdsLog {
public:
    /// `write` is called in threads of DDS, one at a time.
    explicit DdsLog(bridges::Notes::Write write);
    ~DdsLog();
    DdsLog(const DdsLog&) = delete;
    DdsLog& operator=(const DdsLog&) = delete;

    /// From now on lines are handed on as FadingLines does, ever more seldom. Before, all are: what is wrong with a
    /// configuration takes several.
    void calm();

private:
    static void take(void* self, const dds_log_data_t* data);

    std::mutex mutex_;  ///< guards what follows
    bridges::Notes::Write write_;
    FadingLines fading_;
    bool calm_ = false;
};

}  // namespace disparityd::ros2
