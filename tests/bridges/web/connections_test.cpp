// SPDX-License-Identifier: Apache-2.0
#include "bridges/web/http/connections.h"

#include <vector>

#include <gtest/gtest.h>

namespace disparityd::web {
namespace {

class Visit : public Connection {
public:
    explicit Visit(bool is_idle) : is_idle_(is_idle) {}
    void drop() override { dropped = true; }
    bool idle() const override { return is_idle_; }

    bool dropped = false;

private:
    bool is_idle_;
};

constexpr std::size_t places = 64;  // eight of them are kept for requests

class ConnectionsTest : public ::testing::Test {
protected:
    /// Returns nullptr when there is no place for the request.
    static std::shared_ptr<Visit> request(Connections& all, const std::string& peer, bool idle = false) {
        auto visit = std::make_shared<Visit>(idle);
        return all.admit(visit, peer) ? visit : nullptr;
    }

    /// Returns nullptr when there is no place for the stream.
    static std::shared_ptr<Visit> stream(Connections& all, const std::string& peer, Stay stay = Stay::viewer,
                                         bool idle = false) {
        const auto before = request(all, peer, true);
        auto visit = std::make_shared<Visit>(idle);
        if (before == nullptr || !all.promote(before.get(), stay)) {
            return nullptr;
        }
        all.hand_over(before.get(), visit);
        return visit;
    }

    static std::vector<std::shared_ptr<Visit>> streams(Connections& all, std::size_t count, const std::string& peer,
                                                       bool idle = false) {
        std::vector<std::shared_ptr<Visit>> made;
        for (std::size_t i = 0; i < count; ++i) {
            made.push_back(stream(all, peer, Stay::viewer, idle));
            EXPECT_NE(made.back(), nullptr) << i;
        }
        return made;
    }
};

TEST_F(ConnectionsTest, StreamsDoNotTakeThePlacesOfRequests) {
    Connections all(places);
    const auto viewers = streams(all, 56, "a");
    EXPECT_EQ(all.places_for_viewers(), 56U);
    EXPECT_EQ(stream(all, "a"), nullptr) << "streams have all of theirs";
    std::vector<std::shared_ptr<Visit>> requests;
    for (int i = 0; i < 8; ++i) {
        requests.push_back(request(all, "a"));
        ASSERT_NE(requests.back(), nullptr) << i;
    }
    EXPECT_EQ(request(all, "a"), nullptr);
    requests.pop_back();
    EXPECT_NE(request(all, "a"), nullptr);
}

TEST_F(ConnectionsTest, AStreamThatIsToldNothingMakesPlace) {
    Connections all(places);
    const auto silent = streams(all, 56, "a", true);
    EXPECT_NE(stream(all, "a"), nullptr);
    EXPECT_TRUE(silent[0]->dropped) << "the one that came first";
    EXPECT_FALSE(silent[1]->dropped);
}

TEST_F(ConnectionsTest, IdleRequestsEndBeforeIdleStreams) {
    Connections all(places);
    const auto silent = streams(all, 56, "a", true);
    std::vector<std::shared_ptr<Visit>> idle;
    for (int i = 0; i < 8; ++i) {
        idle.push_back(request(all, "a", true));
    }
    const auto next = request(all, "b");
    EXPECT_NE(next, nullptr);
    EXPECT_TRUE(idle[0]->dropped);
    EXPECT_FALSE(silent[0]->dropped);
}

TEST_F(ConnectionsTest, AnAddressWithFewerTakesAPlaceOfTheOneWithMost) {
    Connections all(places);
    const auto many = streams(all, 54, "a");
    const auto few = streams(all, 2, "b");
    const auto other = stream(all, "c");
    ASSERT_NE(other, nullptr);
    EXPECT_TRUE(many.back()->dropped) << "its newest one";
    EXPECT_FALSE(many.front()->dropped);
    EXPECT_FALSE(few[0]->dropped || few[1]->dropped);
    EXPECT_EQ(stream(all, "a"), nullptr) << "and does not get it back";
}

TEST_F(ConnectionsTest, AddressesWithAsManyDoNotExchangePlaces) {
    Connections all(places);
    const auto one = streams(all, 28, "a");
    const auto other = streams(all, 28, "b");
    EXPECT_EQ(stream(all, "a"), nullptr);
    EXPECT_EQ(stream(all, "b"), nullptr);
}

TEST_F(ConnectionsTest, SomePlacesAreKeptForControllers) {
    Connections all(places, true);
    EXPECT_EQ(all.places_for_viewers(), 48U);
    const auto viewers = streams(all, 48, "a");
    EXPECT_EQ(stream(all, "a"), nullptr);
    std::vector<std::shared_ptr<Visit>> controllers;
    for (int i = 0; i < 8; ++i) {
        controllers.push_back(stream(all, "a", Stay::controller));
        ASSERT_NE(controllers.back(), nullptr) << i;
    }
    EXPECT_FALSE(viewers.back()->dropped);
    controllers.push_back(stream(all, "a", Stay::controller));
    EXPECT_NE(controllers.back(), nullptr);
    EXPECT_TRUE(viewers.back()->dropped) << "a controller takes a viewer's place";
    const auto elsewhere = stream(all, "b");
    EXPECT_NE(elsewhere, nullptr);
    for (const auto& controller : controllers) {
        EXPECT_FALSE(controller->dropped) << "a viewer from elsewhere takes a viewer's place";
    }
}

TEST_F(ConnectionsTest, AFewPlacesHaveRoomForRequests) {
    Connections all(8, true);
    EXPECT_EQ(all.places_for_viewers(), 5U);
    const auto viewers = streams(all, 5, "a");
    EXPECT_NE(request(all, "a"), nullptr);
}

TEST_F(ConnectionsTest, WhatHasEndedHoldsNoPlace) {
    Connections all(places);
    auto viewers = streams(all, 56, "a");
    viewers.clear();
    EXPECT_NE(stream(all, "a"), nullptr);
}

}  // namespace
}  // namespace disparityd::web
