// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <list>
#include <memory>
#include <string>

namespace disparityd::web {

/// A connection that can be ended from outside.
class Connection {
public:
    virtual ~Connection() = default;
    /// Ends the connection now.
    virtual void drop() = 0;
    /// Whether it only holds a place: no request of it is being answered, and it is told nothing.
    virtual bool idle() const = 0;
};

/// How long a connection needs its place: for a request, or, as a WebSocket or a stream, until its visitor leaves. A
/// stream with the right to control comes before others.
enum class Stay { request, viewer, controller };

/// Limits the connections of all visitors together. Some places are kept for requests, which are short, and some for
/// controllers: streams never take all. When there is no room, the oldest idle connection makes place for a new one,
/// then one of the address that has the most, where the newcomer's has fewer. The network's thread owns it.
class Connections {
public:
    /// `knows_controllers`: some visitors may control and others may not.
    explicit Connections(std::size_t most, bool knows_controllers = false);

    /// Gives a request a place until it ends. Returns false when there is none. `peer`: the visitor's address.
    bool admit(const std::shared_ptr<Connection>& connection, const std::string& peer);

    /// Makes the place of a request one of a stream. Returns false when streams have all of theirs; the place then
    /// stays what it was.
    bool promote(const Connection* connection, Stay stay);
    /// Gives the place of a connection to the one that it has become.
    void hand_over(const Connection* from, const std::shared_ptr<Connection>& to);

    /// Whether the next one has to take the place of another, as far as the last admit() knows.
    bool full() const { return all_.size() >= most_; }

    /// Returns how many streams without the right to control there may be.
    std::size_t places_for_viewers() const { return most_ - kept_for_requests_ - kept_for_controllers_; }

    /// Ends all.
    void drop_all();

private:
    struct Place {
        std::weak_ptr<Connection> connection;
        std::string peer;
        Stay stay = Stay::request;
    };
    using Places = std::list<Place>;

    void forget_ended();
    bool end_idle(bool streams);
    bool end_one_of_most(const std::string& peer, bool streams, Stay highest);
    bool end_viewer();
    void end(Places::iterator place);
    std::size_t streams() const;

    std::size_t most_;
    std::size_t kept_for_requests_;
    std::size_t kept_for_controllers_;
    Places all_;  ///< the oldest first
};

}  // namespace disparityd::web
