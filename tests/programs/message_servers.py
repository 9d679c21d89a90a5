#!/usr/bin/env python3
"""Servers that take the messages of pinode_watch: one of HTTP, one of SMTP.

    message_servers.py FOLDER

Writes their ports to FOLDER/ports, each HTTP body to FOLDER/posts and each mail
to FOLDER/mails. While FOLDER/closed exists, both refuse.
"""

import http.server
import os
import socketserver
import sys
import threading

FOLDER = sys.argv[1]


def is_closed():
    return os.path.exists(os.path.join(FOLDER, "closed"))


def append(name, text):
    with open(os.path.join(FOLDER, name), "a") as file:
        file.write(text)


class Post(http.server.BaseHTTPRequestHandler):
    def do_POST(self):
        body = self.rfile.read(int(self.headers["Content-Length"])).decode()
        if is_closed():
            self.send_response(503)
        else:
            append("posts", self.headers["Content-Type"] + " " + body + "\n")
            self.send_response(204)
        self.end_headers()

    def log_message(self, *unused):
        pass


class Mail(socketserver.StreamRequestHandler):
    def handle(self):
        def say(text):
            self.wfile.write(text.encode() + b"\r\n")

        say("220 test")
        for line in self.rfile:
            word = line.decode().strip().upper()
            if word.startswith("EHLO"):
                say("250 test")
            elif word.startswith("MAIL") and is_closed():
                say("451 later")
            elif word.startswith(("MAIL", "RCPT", "RSET")):
                append("mails", line.decode())
                say("250 ok")
            elif word == "DATA":
                say("354 go on")
                for text in self.rfile:
                    if text == b".\r\n":
                        break
                    append("mails", text.decode())
                say("250 taken")
            elif word == "QUIT":
                say("221 bye")
                return
            else:
                say("502 unknown")


post = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Post)
mail = socketserver.ThreadingTCPServer(("127.0.0.1", 0), Mail)
with open(os.path.join(FOLDER, "ports.part"), "w") as file:
    file.write("%d %d\n" % (post.server_address[1], mail.server_address[1]))
os.rename(os.path.join(FOLDER, "ports.part"), os.path.join(FOLDER, "ports"))
threading.Thread(target=post.serve_forever, daemon=True).start()
mail.serve_forever()
