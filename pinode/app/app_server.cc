#include "pinode/app/app_server.h"

#include <httplib.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <system_error>
#include <thread>
#include <utility>

#include "pinode/app/page.h"
#include "pinode/app/request_guard.h"
#include "pinode/base/file.h"
#include "pinode/base/strings.h"

namespace pinode {
namespace {

using Json = nlohmann::ordered_json;

// Browsers keep six connections to a host, each of which holds a thread.
constexpr size_t kThreads = 24;
constexpr size_t kRequestsOnConnection = 1000;
// Page: everything from this server, nothing from elsewhere.
constexpr char kPagePolicy[] =
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' "
    "data:; connect-src 'self'; frame-src 'self'; frame-ancestors 'none'; "
    "form-action 'none'; base-uri 'none'";
// Reports carry their own script and style. In the sandbox they are of no
// origin, and can ask this server for nothing.
constexpr char kReportPolicy[] =
    "sandbox allow-scripts; default-src 'none'; script-src 'unsafe-inline' "
    "'unsafe-eval'; style-src 'unsafe-inline'; img-src data: blob:; "
    "frame-ancestors http://127.0.0.1:* http://localhost:*";

// Sets the answer. It goes as it is: httplib would compress a set_content, by
// brotli for as long as 9 s for a report of 0.9 MB, within one computer.
void SetBody(std::string text, const std::string& type,
             httplib::Response* response) {
  if (text.empty()) {
    response->set_content(text, type);
    return;
  }
  const size_t size = text.size();
  const auto body = std::make_shared<const std::string>(std::move(text));
  response->set_content_provider(
      size, type,
      [body](size_t offset, size_t length, httplib::DataSink& sink) {
        return sink.write(body->data() + offset,
                          std::min(length, body->size() - offset));
      });
}

void SetError(int status, const std::string& message,
              httplib::Response* response) {
  response->status = status;
  SetBody(Json{{"error", message}}.dump(-1, ' ', false,
                                        Json::error_handler_t::replace),
          "application/json", response);
}

// Answers with {} or an error.
void SetDone(bool good, const std::string& error, httplib::Response* response) {
  if (good) {
    SetBody("{}", "application/json", response);
  } else {
    SetError(400, error, response);
  }
}

// Reads the body as an object of JSON.
bool ReadObject(const httplib::Request& request, Json* json,
                httplib::Response* response) {
  *json = Json::parse(request.body, nullptr, false);
  if (json->is_object()) return true;
  SetError(400, "the request is not an object of JSON", response);
  return false;
}

int IntOf(const std::string& text, int otherwise) {
  int value = otherwise;
  return ParseInt(text, &value) ? value : otherwise;
}

const char* TypeOf(const std::string& path) {
  const std::string extension =
      std::filesystem::path(path).extension().string();
  if (extension == ".html") return "text/html; charset=utf-8";
  if (extension == ".json") return "application/json";
  return "text/plain; charset=utf-8";
}

}  // namespace

struct AppServer::Parts {
  httplib::Server server;
  Session session;
  RequestRules rules;
  int port = 0;
  std::function<bool()> ends;

  void SetUp();
  void ServePage();
  void ServeSession();
  void ServeFile(const httplib::Request& request, httplib::Response* response);
  void TakeUpload(const httplib::Request& request,
                  const httplib::ContentReader& reader,
                  httplib::Response* response);
  std::string Address(const std::string& rest) const {
    return "/" + rules.token + "/" + rest;
  }
};

void AppServer::Parts::SetUp() {
  server.new_task_queue = [] { return new httplib::ThreadPool(kThreads); };
  server.set_payload_max_length(static_cast<size_t>(rules.upload_bytes));
  server.set_tcp_nodelay(true);
  server.set_keep_alive_max_count(kRequestsOnConnection);
  // A port is of one program: not SO_REUSEPORT, which httplib would set.
  server.set_socket_options([](socket_t socket) {
    const int yes = 1;
    setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof(yes));
  });
  server.set_default_headers({{"Cache-Control", "no-store"},
                              {"Referrer-Policy", "no-referrer"},
                              {"X-Content-Type-Options", "nosniff"},
                              {"X-Frame-Options", "SAMEORIGIN"},
                              {"Cross-Origin-Resource-Policy", "same-origin"}});
  server.set_pre_routing_handler(
      [this](const httplib::Request& request, httplib::Response& response) {
        const Refusal refusal = GuardRequest(
            {request.method, request.path, request.get_header_value("Host"),
             request.get_header_value("Origin"),
             request.get_header_value("Content-Length")},
            rules);
        if (refusal.status == 0)
          return httplib::Server::HandlerResponse::Unhandled;
        SetError(refusal.status, refusal.message, &response);
        return httplib::Server::HandlerResponse::Handled;
      });
  server.set_exception_handler([](const httplib::Request&,
                                  httplib::Response& response,
                                  std::exception_ptr) {
    SetError(500, "the request failed inside of pinode_app", &response);
  });
  ServePage();
  ServeSession();
}

void AppServer::Parts::ServePage() {
  const auto serve = [this](const std::string& name, const std::string& text,
                            const std::string& type) {
    server.Get(Address(name), [text, type](const httplib::Request&,
                                           httplib::Response& response) {
      response.set_header("Content-Security-Policy", kPagePolicy);
      SetBody(text, type, &response);
    });
  };
  serve("", PageHtml(), "text/html; charset=utf-8");
  serve("app.js", PageScript(), "text/javascript; charset=utf-8");
  serve("app.css", PageStyle(), "text/css; charset=utf-8");
  server.Get(Address("files/(.+)"), [this](const httplib::Request& request,
                                           httplib::Response& response) {
    ServeFile(request, &response);
  });
}

void AppServer::Parts::ServeFile(const httplib::Request& request,
                                 httplib::Response* response) {
  const std::string relative = request.matches[1];
  std::string path;
  std::string text;
  std::string error;
  if (!session.FindFile(relative, &path) ||
      !ReadBinaryFile(path, &text, &error)) {
    SetError(404, "there is no such file", response);
    return;
  }
  response->set_header("Content-Security-Policy", kReportPolicy);
  if (request.has_param("save")) {
    const std::string name = std::filesystem::path(path).filename().string();
    response->set_header("Content-Disposition",
                         "attachment; filename=\"" + name + "\"");
  }
  SetBody(std::move(text), TypeOf(path), response);
}

void AppServer::Parts::TakeUpload(const httplib::Request& request,
                                  const httplib::ContentReader& reader,
                                  httplib::Response* response) {
  std::string path;
  std::string error;
  if (!session.BeginUpload(&path, &error)) {
    SetError(400, error, response);
    return;
  }
  std::ofstream file(path, std::ios::binary);
  const bool whole = reader([&](const char* data, size_t size) {
    file.write(data, static_cast<std::streamsize>(size));
    return file.good();
  });
  file.close();
  if (!whole || !file.good()) {
    std::error_code status;
    std::filesystem::remove(path, status);
    SetError(507,
             "the file could not be stored: the disk is full or the "
             "upload was cut off",
             response);
    return;
  }
  const bool good = session.EndUpload(path, request.get_param_value("name"),
                                      request.get_param_value("use"), &error);
  SetDone(good, error, response);
  if (good) session.ReadRecords();
}

void AppServer::Parts::ServeSession() {
  server.Get(Address("state"), [this](const httplib::Request& request,
                                      httplib::Response& response) {
    SetBody(session.State(IntOf(request.get_param_value("version"), 0)),
            "application/json", &response);
  });
  server.Get(Address("view"), [this](const httplib::Request& request,
                                     httplib::Response& response) {
    std::string json;
    std::string error;
    if (session.View(
            request.get_param_value("file"), request.get_param_value("use"),
            request.get_param_value("column"),
            IntOf(request.get_param_value("width"), 600), &json, &error)) {
      SetBody(std::move(json), "application/json", &response);
    } else {
      SetError(404, error, &response);
    }
  });
  server.Get(Address("deck"),
             [this](const httplib::Request&, httplib::Response& response) {
               std::string json;
               std::string error;
               if (session.Deck(&json, &error)) {
                 SetBody(std::move(json), "application/json", &response);
               } else {
                 SetError(404, error, &response);
               }
             });
  server.Get(Address("case"), [this](const httplib::Request& request,
                                     httplib::Response& response) {
    std::string json;
    std::string error;
    if (session.CaseText(request.get_param_value("later") == "1", &json,
                         &error)) {
      SetBody(std::move(json), "application/json", &response);
    } else {
      SetError(404, "there is no case yet; check it first", &response);
    }
  });
  server.Post(
      Address(kUploadPath),
      [this](const httplib::Request& request, httplib::Response& response,
             const httplib::ContentReader& reader) {
        TakeUpload(request, reader, &response);
      });
  server.Post(Address("answers"), [this](const httplib::Request& request,
                                         httplib::Response& response) {
    Json json;
    std::string error;
    if (!ReadObject(request, &json, &response)) return;
    const bool good = session.SetAnswers(json, &error);
    if (good) session.ReadRecords();
    SetDone(good, error, &response);
  });
  server.Post(Address("act"), [this](const httplib::Request& request,
                                     httplib::Response& response) {
    Json json;
    std::string error;
    if (!ReadObject(request, &json, &response)) return;
    const bool good = session.Act(json, &error);
    if (good) session.ReadRecords();
    SetDone(good, error, &response);
  });
  server.Post(Address("quit"),
              [this](const httplib::Request&, httplib::Response& response) {
                SetBody("{}", "application/json", &response);
                server.stop();
              });
}

AppServer::AppServer() : parts_(std::make_unique<Parts>()) {}

AppServer::~AppServer() = default;

bool AppServer::Open(const AppServerOptions& options, std::string* error) {
  parts_->rules.token = options.token;
  parts_->rules.upload_bytes = options.upload_bytes;
  if (options.token.empty() && !MakeToken(&parts_->rules.token, error)) {
    return false;
  }
  if (!parts_->session.Open(options.folder, options.upload_bytes, error)) {
    return false;
  }
  parts_->SetUp();
  if (options.port == 0) {
    parts_->port = parts_->server.bind_to_any_port("127.0.0.1");
  } else if (parts_->server.bind_to_port("127.0.0.1", options.port)) {
    parts_->port = options.port;
  }
  if (parts_->port > 0) return true;
  *error = options.port == 0
               ? "no port of 127.0.0.1 can be opened"
               : "port " + std::to_string(options.port) +
                     " of 127.0.0.1 is in use; give another one with --port, "
                     "or 0 for any that is free";
  return false;
}

std::string AppServer::address() const {
  return "http://127.0.0.1:" + std::to_string(parts_->port) +
         parts_->Address("");
}

int AppServer::port() const { return parts_->port; }

void AppServer::Watch(std::function<bool()> ends) {
  parts_->ends = std::move(ends);
}

void AppServer::Run() {
  // The first page does not wait for large records.
  std::thread reader([this] { parts_->session.ReadRecords(); });
  std::atomic<bool> served{false};
  std::thread watcher([this, &served] {
    while (!served) {
      if (parts_->ends && parts_->ends()) parts_->server.stop();
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
  });
  parts_->server.listen_after_bind();
  served = true;
  watcher.join();
  reader.join();
}

void AppServer::Stop() { parts_->server.stop(); }

Session* AppServer::session() { return &parts_->session; }

}  // namespace pinode
