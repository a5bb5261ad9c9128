#include "core/error.h"
#include "core/files.h"
#include "graph/guard.h"
#include "plugin/loader.h"
#include "support/folders.h"
#include "support/temporary_folder.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <stdexcept>

namespace kestrel {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

fs::path plugin(const std::string& name) {
    return test::buildFolder() / "test_plugins" / name / (name + ".so");
}

TEST(PluginLoader, AGoodPluginBringsItsTypesWithItsName) {
    Registry registry;
    const PluginResult result = loadPlugin(plugin("good"), registry);
    EXPECT_EQ(result.failure, PluginFailure::None) << result.message;
    EXPECT_THAT(result.types, ElementsAre("Good"));
    const PassType* type = registry.find("Good");
    ASSERT_NE(type, nullptr);
    EXPECT_EQ(type->plugin, "good.so");
    EXPECT_EQ(std::get<std::int64_t>(type->property("amount")->defaultValue), 3);
    EXPECT_NE(type->make(), nullptr);
}

TEST(PluginLoader, SaysInWhichWayAPluginIsBadAndLeavesTheRegistryAlone) {
    Registry registry;
    const auto fails = [&](const fs::path& library, PluginFailure failure) {
        const PluginResult result = loadPlugin(library, registry);
        EXPECT_EQ(result.failure, failure) << result.message;
        EXPECT_TRUE(registry.types().empty());
        EXPECT_TRUE(registry.shaderFolders.empty());
        EXPECT_EQ(result.message.find('\n'), std::string::npos);
        const std::string begin = "plugin " + library.string() + " is skipped: ";
        EXPECT_THAT(result.message, StartsWith(begin));
        return result.message.substr(std::min(begin.size(), result.message.size()));
    };
    EXPECT_EQ(fails("/nowhere/at_all.so", PluginFailure::NoFile), "no such file");
    const test::TemporaryFolder folder;
    const fs::path text = folder / "kestrel_text.so";
    writeFile(text, "not a library");
    EXPECT_THAT(fails(text, PluginFailure::NotLoadable), StartsWith("it does not load: "));
    EXPECT_THAT(fails(plugin("lacks_symbol"), PluginFailure::NotLoadable),
                HasSubstr("kestrelTestSymbolThatNobodyHas"));
    EXPECT_EQ(fails(plugin("no_plugin"), PluginFailure::NotAPlugin),
              "it is not a Kestrel plugin (it has no KESTREL_PLUGIN block)");
    EXPECT_EQ(fails(plugin("other_stamp"), PluginFailure::OtherStamp),
              "it was built for another Kestrel: its stamp is [kestrel 0.0.1, headers 0], this one's is [" +
                  abiStamp() + "]; build it again");
    EXPECT_EQ(fails(plugin("throws"), PluginFailure::Threw), "its registration failed: no luck today");
    EXPECT_THAT(fails(plugin("misnamed"), PluginFailure::Threw), HasSubstr("the port name 'Result' is not"));
}

TEST(PluginLoader, ANameCanBeTakenOnce) {
    Registry registry;
    ASSERT_EQ(loadPlugin(plugin("good"), registry).failure, PluginFailure::None);
    const PluginResult result = loadPlugin(plugin("taken"), registry);
    EXPECT_EQ(result.failure, PluginFailure::NameTaken);
    EXPECT_THAT(result.message, HasSubstr("the name of its pass type 'Good' is taken by good.so"));
    EXPECT_EQ(registry.types().size(), 1u);
}

TEST(PluginLoader, APluginThatWasBuiltAnewTakesThePlaceOfItsTypes) {
    const test::TemporaryFolder folder;
    const fs::path library = folder / "good.so";
    // A linker writes another file under the name; the one that is mapped is not written into.
    const auto build = [&](const char* name) {
        fs::remove(library);
        fs::copy_file(plugin(name), library);
    };
    const auto value = [](const Pass& pass) {
        return pass.declare({}, {}, Demand::everything()).outputs.at(0).constant->x;
    };
    build("good");
    Registry registry;
    ASSERT_EQ(loadPlugin(library, registry).failure, PluginFailure::None);
    const auto before = registry.find("Good")->make();
    const std::uint64_t instance = registry.find("Good")->instance;
    build("rebuilt");
    const PluginResult result = reloadPlugin(library, registry);
    EXPECT_EQ(result.message, "");
    EXPECT_THAT(result.types, ElementsAre("Good"));
    EXPECT_NE(registry.find("Good")->instance, instance);
    EXPECT_EQ(registry.find("Good")->plugin, "good.so");
    EXPECT_EQ(value(*registry.find("Good")->make()), 2);
    EXPECT_EQ(value(*before), 1); // its code is there still
    // Nothing is left beside it, and what cannot be taken changes nothing.
    EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), {}), 1);
    build("other_stamp");
    EXPECT_EQ(reloadPlugin(library, registry).failure, PluginFailure::OtherStamp);
    EXPECT_EQ(reloadPlugin(plugin("taken"), registry).failure, PluginFailure::NameTaken);
    EXPECT_EQ(value(*registry.find("Good")->make()), 2);
}

TEST(PluginLoader, LoadsFoldersInOrderAndSkipsWhatIsBad) {
    const test::TemporaryFolder folder;
    fs::create_directories(folder / "shaders");
    for (const char* name : {"throws", "good"})
        fs::copy_file(plugin(name), folder / (std::string(name) + ".so"));
    Registry registry;
    const auto failures = loadPlugins(registry, {folder.path(), "/nowhere"});
    ASSERT_EQ(failures.size(), 2u);
    EXPECT_EQ(failures[0].failure, PluginFailure::Threw);
    EXPECT_EQ(failures[1].failure, PluginFailure::NoFile);
    EXPECT_THAT(registry.names(), ElementsAre("Good"));
    EXPECT_THAT(registry.shaderFolders, ElementsAre(folder / "shaders"));
}

TEST(PluginLoader, TheEnvironmentAddsFoldersToKestrelsOwn) {
    unsetenv("KESTREL_PLUGINS");
    const std::vector<fs::path> own = pluginFolders();
    ASSERT_EQ(own.size(), 1u);
    EXPECT_EQ(own[0].filename(), "kestrel");
    setenv("KESTREL_PLUGINS", ("/one::/two:" + own[0].string()).c_str(), 1);
    const auto folders = pluginFolders();
    unsetenv("KESTREL_PLUGINS");
    EXPECT_GE(folders.size(), 3u);
    EXPECT_EQ(folders[0], own[0]);
    EXPECT_EQ(folders[1], "/one");
    EXPECT_EQ(folders[2], "/two");
}

TEST(PluginLoader, TheStampNamesVersionHeadersAndCompiler) {
    EXPECT_THAT(abiStamp(), testing::MatchesRegex("kestrel [0-9.]+, headers [0-9a-f]+, compiler .*, C\\+\\+ "
                                                  "[0-9]+L?, [a-z-]+, sizes [0-9]+"));
}

TEST(Guard, ForeignExceptionsNameThePassAndTheCall) {
    const auto message = [](auto call) {
        try {
            guarded("ao", "execute", call);
        } catch (const Error& error) {
            return std::string(error.what());
        }
        return std::string("no error");
    };
    EXPECT_EQ(message([] { throw std::out_of_range("index 7"); }), "pass 'ao' failed in execute: index 7");
    EXPECT_EQ(message([] { throw 42; }), "pass 'ao' failed in execute: an exception of unknown kind");
    EXPECT_EQ(message([] { throw MachineError("no GL"); }), "no GL");
    EXPECT_EQ(guarded("ao", "declare", [] { return 5; }), 5);
}

} // namespace
} // namespace kestrel
