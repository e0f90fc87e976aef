// SPDX-License-Identifier: Apache-2.0
#include "capture/bag/bag_survey.h"

#include <algorithm>
#include <stdexcept>

#include "base/message_text.h"
#include "capture/bag/bag_frames.h"
#include "capture/bag/bag_messages.h"

namespace disparityd::capture {
namespace {

/// Takes the messages that describe the cameras, one after the other.
class Survey {
public:
    Survey(const std::string& path, const ChosenTopics& topics) : path_(path), topics_(topics), bag_(path) {}

    BagSurvey read(std::uint64_t most_bytes) {
        constexpr std::uint64_t for_transforms = std::uint64_t{16} << 20U;
        BagMessages::Message message;
        while (bag_.position() < most_bytes && next(message)) {
            if (!found_.left || !found_.right) {
                continue;
            }
            if (topics_.transforms.empty() || has_mounting()) {
                break;
            }
            most_bytes = std::min(most_bytes, bytes_of_infos_ + for_transforms);
        }
        return std::move(found_);
    }

private:
    /// Reads and takes a message; false after the last one. Damage behind what is needed is told when frames are read.
    bool next(BagMessages::Message& message) {
        try {
            if (!bag_.next(message)) {
                return false;
            }
            take(message);
            return true;
        } catch (const std::runtime_error&) {
            if (!found_.left || !found_.right) {
                throw;
            }
            return false;
        }
    }

    void take(const BagMessages::Message& message) {
        const bool left = message.topic == topics_.left_info && !found_.left;
        const bool right = message.topic == topics_.right_info && !found_.right;
        const bool transforms = !topics_.transforms.empty() && message.topic == topics_.transforms;
        const bool imu = !topics_.imu.empty() && message.topic == topics_.imu && imu_frame_.empty();
        if (!left && !right && !transforms && !imu) {
            return;
        }
        const formats::RosMessage fields = bag_.decode(message);
        try {
            if (transforms) {
                frames_.take(fields);
            } else if (imu) {
                imu_frame_ = fields.text("header.frame_id");
            } else {
                (left ? found_.left : found_.right) =
                    camera_info_of(fields, path_ + ": " + base::printable(message.topic));
                bytes_of_infos_ = bag_.position();
            }
            if (left) {
                left_frame_ = fields.text("header.frame_id");
            }
        } catch (const std::runtime_error& error) {
            bag_.fail(message, error.what());
        }
    }

    bool has_mounting() {
        if (!imu_frame_.empty() && !left_frame_.empty()) {
            found_.imu_to_left = frames_.between(imu_frame_, left_frame_);
        }
        return found_.imu_to_left.has_value();
    }

    const std::string path_;
    const ChosenTopics& topics_;
    BagMessages bag_;
    BagSurvey found_;
    BagFrames frames_;
    std::string left_frame_, imu_frame_;
    std::uint64_t bytes_of_infos_ = 0;  ///< where the last of them ends
};

}  // namespace

BagSurvey survey_bag(const std::string& path, const ChosenTopics& topics, std::uint64_t most_bytes) {
    return Survey(path, topics).read(most_bytes);
}

}  // namespace disparityd::capture
