// The server of the page, on 127.0.0.1 only.

#ifndef PINODE_APP_APP_SERVER_H_
#define PINODE_APP_APP_SERVER_H_

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "pinode/app/session.h"

namespace pinode {

struct AppServerOptions {
  // Port; 0: any that is free.
  int port = 0;
  // Folder of all works.
  std::string folder;
  // Largest upload.
  std::int64_t upload_bytes = 500000000;
  // First folder of every address; empty: a random one.
  std::string token;
};

// Serves a Session to browsers on this computer. Addresses begin with a random
// token; other requests are refused (request_guard.h). Answers load nothing
// from elsewhere, and say so to the browser (Content-Security-Policy).
//
//   GET  /TOKEN/            the page; app.js, app.css
//   GET  /TOKEN/state       Session::State; ?version=N
//   GET  /TOKEN/view        Session::View; ?file=&use=&column=&width=
//   GET  /TOKEN/deck        Session::Deck
//   GET  /TOKEN/files/...   Session::FindFile
//   POST /TOKEN/upload      a file as it is; ?name=&use=
//   POST /TOKEN/answers     Session::SetAnswers
//   POST /TOKEN/act         Session::Act
//   POST /TOKEN/quit        ends the server
//
// Errors are {"error": "a sentence"} with a status of 400 or above.
class AppServer {
 public:
  AppServer();
  ~AppServer();
  AppServer(const AppServer&) = delete;
  AppServer& operator=(const AppServer&) = delete;

  // Opens the session and the port.
  [[nodiscard]] bool Open(const AppServerOptions& options, std::string* error);
  // Address of the page, "http://127.0.0.1:PORT/TOKEN/".
  std::string address() const;
  int port() const;

  // Sets a function that is asked several times a second; true ends Run.
  void Watch(std::function<bool()> ends);
  // Serves until Stop is called, from any thread, or the page asks for it. A
  // step that still runs is then stopped, and its checkpoint kept.
  void Run();
  void Stop();

  Session* session();

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace pinode

#endif  // PINODE_APP_APP_SERVER_H_
