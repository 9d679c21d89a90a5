#include "pinode/app/app_server.h"

#include <gtest/gtest.h>
#include <httplib.h>

#include <chrono>
#include <cmath>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>

#include "pinode/base/constants.h"
#include "tests/support/temporary_folder_testing.h"

namespace pinode {
namespace {

using Json = nlohmann::ordered_json;
using std::chrono::milliseconds;

// A logger's file of one second and more at 100 Hz.
std::string Log(int samples = 200) {
  std::string text = "t [s],base [m/s^2],acc_1 [m/s^2]\n";
  for (int i = 0; i < samples; ++i) {
    const double t = 0.01 * i;
    text += std::to_string(t) + "," + std::to_string(std::sin(20.0 * t)) + "," +
            std::to_string(std::cos(31.0 * t)) + "\n";
  }
  return text;
}

class AppServerTest : public ::testing::Test {
 protected:
  void SetUp() override { Start(); }
  void TearDown() override { End(); }

  void Start() {
    AppServerOptions options;
    options.folder = folder_.Path("app");
    options.upload_bytes = 100000;
    std::string error;
    server_ = std::make_unique<AppServer>();
    ASSERT_TRUE(server_->Open(options, &error)) << error;
    const std::string address = server_->address();
    // "http://127.0.0.1:PORT/TOKEN/"
    base_ = address.substr(address.find('/', 8));
    runner_ = std::thread([this] { server_->Run(); });
    client_ = std::make_unique<httplib::Client>("127.0.0.1", server_->port());
    for (int i = 0; i < 1000 && !client_->Get(base_ + "state"); ++i) {
      std::this_thread::sleep_for(milliseconds(5));
    }
  }

  void End() {
    if (server_ == nullptr) return;
    server_->Stop();
    runner_.join();
    server_ = nullptr;
  }

  int StatusOf(const std::string& path,
               const httplib::Headers& headers = {}) const {
    const auto answer = client_->Get(path, headers);
    return answer ? answer->status : -1;
  }
  Json State() const {
    const auto answer = client_->Get(base_ + "state");
    return answer ? Json::parse(answer->body, nullptr, false) : Json();
  }
  // Returns the error of a POST, or "" if it was done.
  std::string Post(const std::string& path, const std::string& body) const {
    const auto answer = client_->Post(base_ + path, body, "application/json");
    if (!answer) return "no answer";
    const Json json = Json::parse(answer->body, nullptr, false);
    EXPECT_EQ(answer->status == 200, !json.contains("error")) << answer->body;
    return json.value("error", "");
  }
  std::string Upload(const std::string& name, const std::string& use,
                     const std::string& content) const {
    httplib::Params query = {{"name", name}, {"use", use}};
    return Post("upload?" + httplib::detail::params_to_query_str(query),
                content);
  }

  // Does an action, waits for its end, and returns the job of the state.
  Json Act(const Json& request) {
    EXPECT_EQ(Post("act", request.dump()), "");
    server_->session()->WaitForJob();
    return State()["job"];
  }

  TemporaryFolder folder_;
  std::unique_ptr<AppServer> server_;
  std::thread runner_;
  std::string base_;
  std::unique_ptr<httplib::Client> client_;
};

TEST_F(AppServerTest, ServesThePageToWhoHasTheToken) {
  const auto page = client_->Get(base_);
  ASSERT_TRUE(page);
  EXPECT_EQ(page->status, 200);
  EXPECT_NE(page->body.find("<title>pinode</title>"), std::string::npos);
  const std::string policy = page->get_header_value("Content-Security-Policy");
  EXPECT_NE(policy.find("default-src 'none'"), std::string::npos);
  EXPECT_EQ(policy.find("unsafe"), std::string::npos);
  EXPECT_EQ(page->get_header_value("Referrer-Policy"), "no-referrer");
  EXPECT_EQ(StatusOf(base_ + "app.js"), 200);
  EXPECT_EQ(StatusOf(base_ + "app.css"), 200);
  for (const std::string path :
       {"/", "/state", "/app.js", "/0123456789abcdef0123456789abcdef/state"}) {
    EXPECT_EQ(StatusOf(path), 403) << path;
  }
  EXPECT_EQ(StatusOf(base_ + "nothing"), 404);
}

TEST_F(AppServerTest, RefusesOtherHostsAndOrigins) {
  EXPECT_EQ(StatusOf(base_ + "state", {{"Host", "evil.example"}}), 403);
  EXPECT_EQ(StatusOf(base_ + "state", {{"Origin", "http://evil.example"}}),
            403);
  EXPECT_EQ(StatusOf(base_ + "state", {{"Origin", "null"}}), 403);
  const std::string own = "127.0.0.1:" + std::to_string(server_->port());
  EXPECT_EQ(
      StatusOf(base_ + "state", {{"Host", own}, {"Origin", "http://" + own}}),
      200);
}

TEST_F(AppServerTest, ShowsWhatAFileHolds) {
  ASSERT_EQ(Upload("before.csv", "baseline", Log()), "");
  const Json file = State()["files"][0];
  EXPECT_EQ(file["state"], "read") << file;
  EXPECT_EQ(file["samples"], 200);
  ASSERT_EQ(file["columns"].size(), 2u);
  EXPECT_EQ(file["columns"][1]["name"], "acc_1");
  EXPECT_EQ(file["columns"][1]["unit"], "m/s^2");
  const auto view = client_->Get(
      base_ + "view?file=before.csv&use=baseline&column=acc_1&width=20");
  ASSERT_TRUE(view);
  EXPECT_LE(Json::parse(view->body)["history"]["x"].size(), 42u);
  EXPECT_EQ(StatusOf(base_ + "view?file=before.csv&use=later&column=acc_1"),
            404);
  EXPECT_EQ(StatusOf(base_ + "view?file=before.csv&use=baseline&column=x"),
            404);

  ASSERT_EQ(Upload("bad.csv", "later", "no numbers\n"), "");
  EXPECT_EQ(State()["files"][1]["state"], "failed");
  EXPECT_NE(State()["files"][1]["error"], "");
  // The same file again replaces it.
  ASSERT_EQ(Upload("before.csv", "baseline", Log(300)), "");
  EXPECT_EQ(State()["files"].size(), 2u);
  EXPECT_EQ(State()["files"][0]["samples"], 300);
}

TEST_F(AppServerTest, StoresHostileNamesInItsFolder) {
  ASSERT_EQ(Upload("../../../evil.csv", "baseline", Log()), "");
  EXPECT_EQ(State()["files"][0]["name"], "evil.csv");
  EXPECT_FALSE(std::filesystem::exists(folder_.Path("evil.csv")));
  EXPECT_TRUE(
      std::filesystem::exists(folder_.Path("app/work_1/records/evil.csv")));
  ASSERT_EQ(Upload("<script>alert(1)<_script>\n.csv", "baseline", Log()), "");
  EXPECT_EQ(State()["files"][1]["name"], "<script>alert(1)<_script>.csv");
  EXPECT_NE(Upload("a.csv", "../..", Log()), "");
  EXPECT_EQ(State()["files"].size(), 2u);

  for (const std::string path :
       {"files/../../../etc/passwd", "files/%2e%2e/%2e%2e/secret",
        "files/work.json", "files//etc/passwd", "files/case.toml"}) {
    EXPECT_EQ(StatusOf(base_ + path), 404) << path;
  }
}

TEST_F(AppServerTest, LimitsUploads) {
  EXPECT_NE(
      Upload("large.csv", "baseline", std::string(100001, '1')).find("0.1 MB"),
      std::string::npos);
  EXPECT_TRUE(State()["files"].empty());
  EXPECT_EQ(Upload("full.csv", "baseline", Log(2000)), "");
  EXPECT_EQ(State()["files"].size(), 1u);
  // Nothing of either is left beside the work.
  int others = 0;
  for (const auto& entry :
       std::filesystem::directory_iterator(folder_.Path("app"))) {
    const std::string name = entry.path().filename().string();
    others += name != "work_1" && name != "lock" ? 1 : 0;
  }
  EXPECT_EQ(others, 0);
}

TEST_F(AppServerTest, RefusesWhatIsNoRequestOfThePage) {
  EXPECT_NE(Post("answers", "{"), "");
  EXPECT_NE(Post("answers", "[1]"), "");
  EXPECT_NE(Post("answers", "{\"answers\": {\"case_path\": \"/x\"}}"), "");
  EXPECT_NE(Post("answers", "{\"answers\": {\"storeys\": 5}}"), "");
  EXPECT_NE(Post("act", "{\"action\": \"format\"}"), "");
  EXPECT_NE(Post("act", "{\"action\": 7}"), "");
  EXPECT_NE(Post("act", "{\"action\": \"fit\"}"), "");
  EXPECT_NE(Post("act", "{\"action\": \"compare\", \"resume\": true}"), "");
  EXPECT_NE(Post("act", "{\"action\": \"open\", \"work\": \"../..\"}"), "");
  EXPECT_NE(Post("act",
                 "{\"action\": \"remove\", \"name\": \"../work.json\", "
                 "\"use\": \"baseline\"}"),
            "");
  EXPECT_EQ(StatusOf(base_ + "state"), 200);
}

TEST_F(AppServerTest, AsksForWhatIsMissing) {
  EXPECT_EQ(Post("act", "{\"action\": \"check\"}"), "");
  server_->session()->WaitForJob();
  EXPECT_NE(State()["job"]["problem"], "");
  ASSERT_EQ(Upload("before.csv", "baseline", Log()), "");
  EXPECT_EQ(Post("act", "{\"action\": \"check\"}"), "");
  server_->session()->WaitForJob();
  EXPECT_EQ(State()["job"]["question"]["flag"], "storeys");
  EXPECT_EQ(State()["is_checked"], false);

  EXPECT_EQ(Post("answers",
                 "{\"answers\": {\"storeys\": \"1\", \"weights\": "
                 "\"2000 kg\", \"first_mode_hz\": \"5\"}}"),
            "");
  EXPECT_EQ(State()["guessed"]["acc_1"], "1");
  EXPECT_EQ(State()["guessed"]["base"], "base");
  EXPECT_EQ(Post("act", "{\"action\": \"check\"}"), "");
  server_->session()->WaitForJob();
  EXPECT_EQ(State()["is_checked"], true) << State()["job"];
  EXPECT_EQ(State()["check"]["schema"], "pinode-check-1");
  EXPECT_EQ(StatusOf(base_ + "files/case.toml"), 200);
  // A case that was edited by hand stays.
  const std::string edited =
      folder_.Read("app/work_1/case.toml") + "[solver]\n";
  folder_.Write("app/work_1/case.toml", edited);
  EXPECT_EQ(Post("act", "{\"action\": \"check\"}"), "");
  server_->session()->WaitForJob();
  EXPECT_NE(State()["job"]["problem"].get<std::string>().find("by hand"),
            std::string::npos)
      << State()["job"];
  EXPECT_EQ(folder_.Read("app/work_1/case.toml"), edited);
  // An answer that changes makes the check an old one.
  EXPECT_EQ(Post("answers", "{\"places\": {\"acc_1\": \"-1\"}}"), "");
  EXPECT_EQ(State()["is_checked"], false);
}

TEST_F(AppServerTest, AsksForPlacesThatNoNameStates) {
  ASSERT_EQ(Upload("a.csv", "baseline",
                   "t [s],base [m/s^2],left [m/s^2]\n" +
                       Log().substr(Log().find('\n') + 1)),
            "");
  EXPECT_EQ(Post("answers",
                 "{\"answers\": {\"storeys\": \"1\", \"weights\": "
                 "\"2000 kg\", \"first_mode_hz\": \"5\"}, "
                 "\"places\": {\"base\": \"base\"}}"),
            "");
  EXPECT_EQ(Post("act", "{\"action\": \"check\"}"), "");
  server_->session()->WaitForJob();
  EXPECT_EQ(State()["job"]["question"]["flag"], "sensors") << State()["job"];
  EXPECT_EQ(Post("answers", "{\"places\": {\"left\": \"-1\"}}"), "");
  EXPECT_EQ(Post("act", "{\"action\": \"check\"}"), "");
  server_->session()->WaitForJob();
  EXPECT_EQ(State()["is_checked"], true) << State()["job"];
  EXPECT_NE(folder_.Read("app/work_1/case.toml").find("sign      = -1"),
            std::string::npos);
}

// Two tabs: what one of them shows is older than what the other has sent.
TEST_F(AppServerTest, KeepsThePlacesThatAnotherTabHasSet) {
  ASSERT_EQ(Upload("a.csv", "baseline", Log()), "");
  EXPECT_EQ(Post("answers", "{\"places\": {\"acc_1\": \"-1\"}}"), "");
  EXPECT_EQ(Post("answers",
                 "{\"places\": {\"base\": \"base\"}, \"places_if_none\": "
                 "{\"acc_1\": \"1\", \"base\": \"2\", \"other\": \"3\"}}"),
            "");
  const Json places = State()["places"];
  EXPECT_EQ(places["acc_1"], "-1");
  EXPECT_EQ(places["base"], "base");
  EXPECT_EQ(places["other"], "3");
  EXPECT_NE(Post("answers", "{\"places_if_none\": {\"base\": 2}}"), "");
}

TEST_F(AppServerTest, SavesACaseThatWasEdited) {
  EXPECT_EQ(StatusOf(base_ + "case?later=0"), 404);
  ASSERT_EQ(Upload("before.csv", "baseline", Log()), "");
  EXPECT_EQ(Post("answers",
                 "{\"answers\": {\"storeys\": \"1\", \"weights\": "
                 "\"2000 kg\", \"first_mode_hz\": \"5\"}}"),
            "");
  EXPECT_EQ(Act({{"action", "check"}})["problem"], "");
  const std::string path = "app/work_1/case.toml";
  const std::string before = folder_.Read(path);
  const auto answer = client_->Get(base_ + "case?later=0");
  ASSERT_TRUE(answer);
  EXPECT_EQ(Json::parse(answer->body)["text"], before);
  EXPECT_EQ(StatusOf(base_ + "case?later=1"), 404);

  const auto save = [&](const std::string& text, const std::string& from) {
    return Act({{"action", "save_case"}, {"text", text}, {"before", from}})
        .value("problem", "");
  };
  // The line of the error is that of the text; the folder is not named.
  const std::string wrong = save(before + "[option]\n", before);
  EXPECT_EQ(wrong.rfind("case.toml:", 0), 0u) << wrong;
  EXPECT_EQ(folder_.Read(path), before);
  const std::string after = before + "[options]\nmax_iterations = 7\n";
  EXPECT_NE(save(after, "older").find("has changed"), std::string::npos);
  EXPECT_EQ(folder_.Read(path), before);
  EXPECT_EQ(Post("answers", "{\"answers\": {\"title\": \"A\"}}"), "");
  EXPECT_EQ(State()["is_checked"], false);
  EXPECT_EQ(save(after, before), "");
  EXPECT_EQ(folder_.Read(path), after);
  EXPECT_EQ(State()["is_checked"], true);
  EXPECT_EQ(State()["is_result_old"], true);

  // A draft replaces it only where this is asked for.
  EXPECT_NE(Act({{"action", "check"}})["problem"], "");
  EXPECT_EQ(folder_.Read(path), after);
  EXPECT_EQ(Act({{"action", "check"}, {"anew", true}})["problem"], "");
  EXPECT_EQ(folder_.Read(path).find("max_iterations"), std::string::npos);
}

TEST_F(AppServerTest, ComparesOnlyWithWorksThatHaveAResult) {
  ASSERT_EQ(Upload("after.csv", "later", Log()), "");
  EXPECT_EQ(Post("act", "{\"action\": \"new\"}"), "");
  ASSERT_EQ(Upload("after.csv", "later", Log()), "");
  for (const char* earlier : {"work_1", "work_2", "work_9", "../app/work_1"}) {
    const Json request = {{"action", "compare"}, {"earlier", earlier}};
    EXPECT_NE(Post("act", request.dump()), "") << earlier;
  }
  EXPECT_TRUE(State()["earlier_works"].empty());
  // The result is there, but not the records that it came from.
  std::filesystem::create_directories(folder_.Path("app/work_1/result"));
  folder_.Write("app/work_1/result/result.json", "{}");
  EXPECT_EQ(State()["earlier_works"], Json({"work_1"}));
  const Json job = Act({{"action", "compare"}, {"earlier", "work_1"}});
  EXPECT_EQ(job["problem"], "work_1 has no records to compare with");
  EXPECT_EQ(State()["compared_with"], "work_1");
}

TEST_F(AppServerTest, KeepsItsWorks) {
  ASSERT_EQ(Upload("before.csv", "baseline", Log()), "");
  EXPECT_EQ(Post("answers", "{\"answers\": {\"storeys\": \"7\"}}"), "");
  EXPECT_EQ(Post("act", "{\"action\": \"new\"}"), "");
  EXPECT_EQ(State()["work"], "work_2");
  EXPECT_TRUE(State()["files"].empty());
  EXPECT_EQ(Post("act", "{\"action\": \"open\", \"work\": \"work_1\"}"), "");
  EXPECT_EQ(State()["answers"]["storeys"], "7");

  // Another program cannot take the folder; after the end of this one it finds
  // everything as it was.
  AppServer other;
  AppServerOptions options;
  options.folder = folder_.Path("app");
  std::string error;
  EXPECT_FALSE(other.Open(options, &error));
  EXPECT_NE(error.find("--folder"), std::string::npos) << error;
  const std::string old_base = base_;
  End();
  Start();
  EXPECT_NE(base_, old_base) << "each start has a token of its own";
  EXPECT_EQ(State()["work"], "work_2");
  EXPECT_EQ(Post("act", "{\"action\": \"open\", \"work\": \"work_1\"}"), "");
  EXPECT_EQ(State()["files"][0]["state"], "read");
  EXPECT_EQ(Post("act",
                 "{\"action\": \"use\", \"name\": \"before.csv\", "
                 "\"use\": \"baseline\", \"to\": \"later\"}"),
            "");
  EXPECT_EQ(State()["files"][0]["use"], "later");
  EXPECT_EQ(State()["files"][0]["state"], "read");
  EXPECT_EQ(Post("act",
                 "{\"action\": \"remove\", \"name\": \"before.csv\", "
                 "\"use\": \"later\"}"),
            "");
  EXPECT_TRUE(State()["files"].empty());
}

TEST_F(AppServerTest, SendsNoStateThatIsKnown) {
  const Json state = State();
  const std::string path =
      base_ + "state?version=" + std::to_string(state["version"].get<int>());
  const auto again = client_->Get(path);
  ASSERT_TRUE(again);
  EXPECT_EQ(Json::parse(again->body).size(), 1u);
  EXPECT_EQ(Post("answers", "{\"answers\": {\"title\": \"A\"}}"), "");
  const auto changed = client_->Get(path);
  ASSERT_TRUE(changed);
  EXPECT_GT(Json::parse(changed->body).size(), 10u);
}

}  // namespace
}  // namespace pinode
