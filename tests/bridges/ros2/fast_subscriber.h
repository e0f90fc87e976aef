// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

/// Subscribes with Fast DDS, which nodes of ROS 2 use by default: another implementation than the bridge's.
namespace disparityd::test {

/// A message as it came.
struct FastMessage {
    std::string bytes;            ///< CDR with its header; the last word may have been filled with zeros
    std::int64_t source_ns = 0;   ///< when it was written, CLOCK_REALTIME
    std::int64_t arrived_ns = 0;  ///< when the callback got it, CLOCK_REALTIME
};

/// Returns the stamp that an image, a camera's information, a cloud and a scan begin with, in ns. Throws
/// std::runtime_error for a message that is too short for one.
std::int64_t stamp_of(const FastMessage& message);

/// What a subscriber asks for.
struct FastQuality {
    bool reliable = true;
    bool transient_local = false;
    int depth = 5;
};

/// A participant on the loopback interface alone. Messages are kept until they are taken.
class FastSubscriber {
public:
    /// `own_buffers`: it asks the system to keep 4 MiB of datagrams, as who wants images should.
    explicit FastSubscriber(std::uint32_t domain, bool own_buffers = true);
    ~FastSubscriber();
    FastSubscriber(const FastSubscriber&) = delete;
    FastSubscriber& operator=(const FastSubscriber&) = delete;

    /// Subscribes to a topic of DDS ("rt/name") of a type ("package::msg::dds_::Name_").
    void subscribe(const std::string& topic, const std::string& type, const FastQuality& quality = {});

    /// Ends one subscription.
    void unsubscribe(const std::string& topic);

    /// Returns how many writers of the topic it has been matched with.
    int writers(const std::string& topic);

    /// Returns the USER_DATA of a writer of the topic that was found, matched or not; "" while there is none.
    std::string user_data(const std::string& topic);

    /// Returns the USER_DATA of the participants that were found.
    std::vector<std::string> participants();

    /// Takes what came, in order.
    std::vector<FastMessage> take(const std::string& topic);

    /// Waits until `done` holds, which is asked when something comes; false when it does not within the time.
    bool wait(const std::function<bool()>& done, std::chrono::seconds most = std::chrono::seconds(30));

private:
    class Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace disparityd::test
