import { spawn } from "node:child_process";

/** Starts the program and waits for its address. */
export async function startProgram(program, args) {
  const child = spawn(program, args, { stdio: ["ignore", "pipe", "inherit"] });
  const address = await new Promise((resolve, reject) => {
    let said = "";
    child.stdout.on("data", (data) => { said += data; const found = said.match(/http:\S+/); if (found) resolve(found[0]); });
    child.on("exit", () => reject(new Error("slalom view ended: " + said)));
  });
  return { child, address, port: new URL(address).port, stop: () => new Promise((done) => { child.removeAllListeners("exit"); child.on("exit", done); child.kill("SIGTERM"); }) };
}
