#include "execute/schedule.h"
#include <gtest/gtest.h>

namespace kestrel {
namespace {

PlanPass passOf(std::string name, Causes depends, std::vector<int> inputs = {}, bool always = false) {
    PlanPass pass;
    pass.name = std::move(name);
    pass.depends = depends;
    pass.inputs = std::move(inputs);
    pass.always = always;
    return pass;
}

// A static map, an image of the camera, rays of each frame on both, and their mean.
Plan examplePlan() {
    Plan plan;
    plan.passes = {passOf("map", Causes::Geometry | Causes::Transforms), passOf("gbuffer", Causes::Camera),
                   passOf("rays", Causes::Frame, {0, 1}), passOf("mean", Causes::None, {2}, true),
                   passOf("view", Causes::None, {1})};
    plan.passes[2].inputPasses = {{"map", {0}}, {"depth", {1}}};
    return plan;
}

std::vector<bool> runsOf(const std::vector<PassState>& states) {
    std::vector<bool> runs;
    for (const PassState& state : states) runs.push_back(state.runs);
    return runs;
}

void finish(std::vector<PassState>& states) {
    for (PassState& state : states)
        if (state.runs) state.pending = Causes::None;
}

TEST(Schedule, EverythingRunsFirstForAllCauses) {
    const Plan plan = examplePlan();
    std::vector<PassState> states(plan.passes.size());
    schedule(plan, Causes::All, Causes::None, states);
    EXPECT_EQ(runsOf(states), (std::vector<bool>{true, true, true, true, true}));
    for (const PassState& state : states) EXPECT_EQ(state.causes, Causes::All);
}

TEST(Schedule, WhatNothingChangedIsLeftAsItIs) {
    const Plan plan = examplePlan();
    std::vector<PassState> states(plan.passes.size());
    schedule(plan, Causes::All, Causes::None, states);
    finish(states);
    schedule(plan, Causes::Frame, Causes::All, states);
    EXPECT_EQ(runsOf(states), (std::vector<bool>{false, false, true, true, false}));
    EXPECT_EQ(states[3].causes, Causes::Frame);
}

TEST(Schedule, CausesTravelDownstream) {
    const Plan plan = examplePlan();
    std::vector<PassState> states(plan.passes.size());
    schedule(plan, Causes::All, Causes::None, states);
    finish(states);
    schedule(plan, Causes::Frame | Causes::Camera, Causes::Frame, states);
    EXPECT_EQ(runsOf(states), (std::vector<bool>{false, true, true, true, true}));
    EXPECT_EQ(states[2].causes, Causes::Frame | Causes::Camera);
    EXPECT_EQ(inputCauses(plan.passes[2], "map", states), Causes::None);
    EXPECT_EQ(inputCauses(plan.passes[2], "depth", states), Causes::Camera);
    EXPECT_EQ(inputCauses(plan.passes[2], "nothing", states), Causes::None);
}

TEST(Schedule, WhatAlwaysRunsHoldsSomethingNewEachFrame) {
    Plan plan;
    plan.passes = {passOf("history", Causes::None, {}, true), passOf("reader", Causes::None, {0})};
    std::vector<PassState> states(2);
    schedule(plan, Causes::All, Causes::None, states);
    finish(states);
    schedule(plan, Causes::Frame, Causes::All, states);
    EXPECT_TRUE(states[0].runs);
    EXPECT_EQ(states[0].causes, Causes::None);
    EXPECT_EQ(states[1].causes, Causes::Frame);
}

TEST(Schedule, ReadersOfLastMotionRunOneFrameLonger) {
    Plan plan;
    plan.passes = {passOf("motion", Causes::Camera), passOf("depth", Causes::Camera)};
    std::vector<PassState> states(2);
    states[0].readsLastMotion = true;
    schedule(plan, Causes::All, Causes::None, states);
    finish(states);
    schedule(plan, Causes::Frame, Causes::All, states); // after a cut there is no motion to take back
    EXPECT_EQ(runsOf(states), (std::vector<bool>{false, false}));
    schedule(plan, Causes::Frame | Causes::Camera, Causes::Frame, states);
    finish(states);
    schedule(plan, Causes::Frame, Causes::Frame | Causes::Camera, states);
    EXPECT_EQ(runsOf(states), (std::vector<bool>{true, false}));
    schedule(plan, Causes::Frame, Causes::Frame, states);
    EXPECT_EQ(runsOf(states), (std::vector<bool>{false, false}));
}

TEST(Schedule, WhatIsDoneInThisFrameDoesNotRunAgainAndStillChangesItsReaders) {
    const Plan plan = examplePlan();
    std::vector<PassState> states(plan.passes.size());
    for (PassState& state : states) state.pending = Causes::None;
    states[1].done = true;
    states[1].changed = Causes::Camera;
    schedule(plan, Causes::Frame | Causes::Camera, Causes::Frame, states);
    EXPECT_FALSE(states[1].runs);
    EXPECT_EQ(states[2].causes, Causes::Frame | Causes::Camera);
}

TEST(Events, TellWhatDiffersBetweenTwoFrames) {
    FrameConditions last;
    last.size = {64, 32, 1};
    SceneFacts facts;
    facts.geometryMoves = true;
    EXPECT_EQ(eventsBetween(last, last, facts), Causes::Frame);

    FrameConditions now = last;
    now.time = 1.0 / 60;
    EXPECT_EQ(eventsBetween(last, now, facts), Causes::Frame | Causes::Transforms);
    facts.geometryDeforms = true;
    EXPECT_EQ(eventsBetween(last, now, facts), Causes::Frame | Causes::Transforms | Causes::Geometry);
    EXPECT_EQ(eventsBetween(last, now, SceneFacts{}), Causes::Frame);

    now = last;
    now.cameraState.position.x = 1;
    EXPECT_EQ(eventsBetween(last, now, facts), Causes::Frame | Causes::Camera);
    now = last;
    now.camera = 1;
    EXPECT_EQ(eventsBetween(last, now, facts), Causes::Frame | Causes::Cut);
    now = last;
    now.jumped = true;
    EXPECT_EQ(eventsBetween(last, now, facts), Causes::Frame | Causes::Cut);
    now = last;
    now.lights.emplace_back();
    EXPECT_EQ(eventsBetween(last, now, facts), Causes::Frame | Causes::Lights);
    now = last;
    now.size.width = 65;
    EXPECT_EQ(eventsBetween(last, now, facts), Causes::Frame | Causes::Size);
}

} // namespace
} // namespace kestrel
