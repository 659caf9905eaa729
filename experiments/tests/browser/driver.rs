//! A browser by remote control: chromedriver, spoken to in the WebDriver protocol (W3C, 2018).

use std::net::TcpListener;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use serde_json::{Value, json};
use tempfile::TempDir;

/// Longest wait for anything that the browser is to do.
const PATIENCE: Duration = Duration::from_secs(60);

/// Keys of the keyboard that are no letters.
pub(crate) const LEFT: &str = "\u{e012}";
pub(crate) const UP: &str = "\u{e013}";
pub(crate) const RIGHT: &str = "\u{e014}";
pub(crate) const DOWN: &str = "\u{e015}";
pub(crate) const ESCAPE: &str = "\u{e00c}";

/// A browser window. Both programs end with it.
pub(crate) struct Browser {
    process: Child,
    session: String,
    agent: ureq::Agent,
    _profile: TempDir,
}

impl Browser {
    /// Starts chromedriver on a free port, and a headless browser with an empty profile of its own.
    ///
    /// # Panics
    /// Without chromium and chromedriver: on Debian `apt-get install chromium chromium-driver`.
    pub(crate) fn start() -> Self {
        let port = TcpListener::bind("127.0.0.1:0").and_then(|free| free.local_addr()).expect("a free port").port();
        let mut process = Command::new("chromedriver")
            .arg(format!("--port={port}"))
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .expect("chromedriver is needed: apt-get install chromium chromium-driver");
        let agent: ureq::Agent =
            ureq::Agent::config_builder().http_status_as_error(false).timeout_global(Some(PATIENCE)).build().into();
        let profile = tempfile::tempdir().expect("temporary folder");
        let root = format!("http://127.0.0.1:{port}");
        let start = Instant::now();
        while agent.get(format!("{root}/status")).call().is_err() {
            if start.elapsed() > PATIENCE {
                let _ = process.kill();
                panic!("chromedriver does not answer on port {port}");
            }
            sleep(Duration::from_millis(50));
        }
        let mut browser = Self { process, session: root.clone(), agent, _profile: profile };
        let session = browser.post("/session", &capabilities(browser._profile.path()));
        let id = session["sessionId"].as_str().unwrap_or_else(|| panic!("no browser: {session}")).to_owned();
        browser.session = format!("{root}/session/{id}");
        browser
    }

    /// Sends a command and gives the value of the answer.
    pub(crate) fn post(&self, path: &str, body: &Value) -> Value {
        let answer = self.agent.post(format!("{}{path}", self.session)).send_json(body);
        let answer: Value = answer.and_then(|mut a| a.body_mut().read_json()).expect("chromedriver answers");
        let value = answer["value"].clone();
        assert!(value.get("error").is_none(), "{path} {body}: {value}");
        value
    }

    /// Opens a page from the file system, and waits until its viewer is ready.
    pub(crate) fn open(&self, page: &Path, fragment: &str) {
        self.post("/url", &json!({ "url": format!("file://{}{fragment}", page.display()) }));
        self.ready();
    }

    /// Waits until the viewer has unpacked what was chosen.
    pub(crate) fn ready(&self) {
        self.wait("document.getElementById('viewer').getAttribute('aria-busy') === 'false'");
    }

    /// Waits until an expression is true.
    pub(crate) fn wait(&self, expression: &str) {
        let start = Instant::now();
        while self.get(expression) != json!(true) {
            assert!(start.elapsed() < PATIENCE, "never true: {expression}");
            sleep(Duration::from_millis(20));
        }
    }

    /// The value of an expression in the page.
    pub(crate) fn get(&self, expression: &str) -> Value {
        self.post("/execute/sync", &json!({ "script": format!("return {expression};"), "args": [] }))
    }

    /// The text of the first element that a CSS selector finds.
    pub(crate) fn text(&self, selector: &str) -> String {
        let text = self.get(&format!("document.querySelector({}).textContent", json!(selector)));
        text.as_str().unwrap_or_else(|| panic!("{selector}: {text}")).to_owned()
    }

    fn element(&self, selector: &str) -> String {
        let found = self.post("/element", &json!({ "using": "css selector", "value": selector }));
        let id = found.as_object().and_then(|o| o.values().next()).and_then(Value::as_str);
        id.unwrap_or_else(|| panic!("{selector}: {found}")).to_owned()
    }

    /// Clicks on an element; on an option to choose it.
    pub(crate) fn click(&self, selector: &str) {
        self.post(&format!("/element/{}/click", self.element(selector)), &json!({}));
    }

    /// Chooses from a list of the viewer.
    pub(crate) fn choose(&self, list: &str, value: &str) {
        self.click(&format!("#viewer-{list} option[value={}]", json!(value)));
        self.ready();
    }

    /// Gives an element the focus and presses keys on it.
    pub(crate) fn press(&self, selector: &str, keys: &str) {
        self.post(&format!("/element/{}/value", self.element(selector)), &json!({ "text": keys }));
    }

    /// Moves the pointer to a point of an element, px from its centre.
    pub(crate) fn hover(&self, selector: &str, x: i64, y: i64) {
        let origin = json!({ "element-6066-11e4-a52e-4f735466cecf": self.element(selector) });
        let step = json!({ "type": "pointerMove", "duration": 0, "origin": origin, "x": x, "y": y });
        self.post("/actions", &json!({ "actions": [{ "type": "pointer", "id": "mouse", "actions": [step] }] }));
    }

    /// Presses keys wherever the focus is.
    pub(crate) fn type_keys(&self, keys: &str) {
        let strokes: Vec<Value> = keys
            .chars()
            .flat_map(|key| ["keyDown", "keyUp"].map(|kind| json!({ "type": kind, "value": key.to_string() })))
            .collect();
        self.post("/actions", &json!({ "actions": [{ "type": "key", "id": "keyboard", "actions": strokes }] }));
    }

    /// Drags from one point of an element to another, px from its centre.
    pub(crate) fn drag(&self, selector: &str, from: [i64; 2], to: [i64; 2]) {
        let origin = json!({ "element-6066-11e4-a52e-4f735466cecf": self.element(selector) });
        let step = |[x, y]: [i64; 2]| json!({ "type": "pointerMove", "duration": 0, "origin": origin, "x": x, "y": y });
        let press = |kind: &str| json!({ "type": kind, "button": 0 });
        let steps = [step(from), press("pointerDown"), step(to), press("pointerUp")];
        self.post("/actions", &json!({ "actions": [{ "type": "pointer", "id": "mouse", "actions": steps }] }));
    }

    /// What the rules of axe-core, whose source is given, find in the page: rule, how bad, and the elements.
    pub(crate) fn findings(&self, axe: &str) -> Vec<Value> {
        self.post("/execute/sync", &json!({ "script": axe, "args": [] }));
        let script = "const done = arguments[arguments.length - 1];
            axe.run(document).then(({ violations }) => done(violations.map(({ id, impact, nodes }) =>
                [id, impact, nodes.map(({ html, failureSummary }) => [html, failureSummary])])), (error) => done([`${error}`]));";
        let found = self.post("/execute/async", &json!({ "script": script, "args": [] }));
        found.as_array().cloned().unwrap_or_else(|| panic!("axe-core did not run: {found}"))
    }

    /// Speaks to the browser itself (Chrome DevTools Protocol).
    pub(crate) fn devtools(&self, command: &str, parameters: &Value) {
        self.post("/goog/cdp/execute", &json!({ "cmd": command, "params": parameters }));
    }

    /// What the browser noted since it was last asked: `browser` for the console, `performance` for the network.
    pub(crate) fn notes(&self, kind: &str) -> Vec<Value> {
        self.post("/se/log", &json!({ "type": kind })).as_array().cloned().unwrap_or_default()
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        let _ = self.agent.delete(&self.session).call();
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

fn capabilities(profile: &Path) -> Value {
    let switches = [
        "--headless=new",
        "--no-sandbox",
        "--disable-gpu",
        "--disable-dev-shm-usage",
        "--disable-background-networking",
        "--no-first-run",
        "--disable-component-update",
        "--disable-sync",
        "--window-size=1280,1600",
    ];
    let mut args: Vec<String> = switches.map(str::to_owned).to_vec();
    args.push(format!("--user-data-dir={}", profile.display()));
    json!({ "capabilities": { "alwaysMatch": {
        "goog:chromeOptions": { "args": args },
        "goog:loggingPrefs": { "browser": "ALL", "performance": "ALL" },
    } } })
}
