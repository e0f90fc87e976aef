// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <list>
#include <memory>

namespace disparityd::web {

/// Bounds the bytes that wait in this program to be sent, over all connections: what was made counts until it is out. A
/// peer that reads nothing so holds memory only while nobody else needs it. The network's thread uses it; it outlives
/// what it counts.
class Outgoing {
public:
    using Time = std::chrono::steady_clock::time_point;

    /// Bytes of frames and answers together; one message more may come on top.
    static constexpr std::size_t usual_most = std::size_t{256} << 20U;
    /// Snapshots are made while less than this waits: frames come first.
    static constexpr std::size_t most_for_snapshots = std::size_t{64} << 20U;

    explicit Outgoing(std::size_t most = usual_most) : most_(most) {}

    /// Bytes that wait, counted as long as this object lives.
    class Load {
    public:
        ~Load();
        Load(const Load&) = delete;
        Load& operator=(const Load&) = delete;

    private:
        friend class Outgoing;
        Load(Outgoing& all, std::size_t bytes, Time since, std::function<void()> drop)
            : all_(all), bytes_(bytes), since_(since), drop_(std::move(drop)) {}

        Outgoing& all_;
        std::size_t bytes_;
        Time since_;
        std::function<void()> drop_;  ///< ends the connection
        std::list<Load*>::iterator place_;
    };

    /// Counts bytes. `drop` ends their connection; it is called at most once, from has_room().
    std::unique_ptr<Load> hold(std::size_t bytes, Time now, std::function<void()> drop);

    /// Returns whether less than `most` waits. If not, it ends connections that are slower than 1 MiB/s and have had
    /// two seconds besides, those with the most bytes first.
    bool has_room(Time now, std::size_t most);
    bool has_room(Time now) { return has_room(now, most_); }

    std::size_t bytes() const { return bytes_; }

private:
    bool end_slowest(Time now);
    void release(const Load& load);

    std::size_t most_;
    std::size_t bytes_ = 0;
    std::size_t peak_ = 0;  ///< since memory was given back
    std::list<Load*> loads_;
};

}  // namespace disparityd::web
