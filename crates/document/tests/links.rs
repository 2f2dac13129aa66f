//! Share links: short, readable, and clear about what is wrong with a broken one.

use limn_document::command::Command;
use limn_document::{LinkError, link};

fn texts(fragment: &str) -> Vec<String> {
    link::read(fragment).unwrap_or_else(|e| panic!("{fragment}: {e}")).iter().map(Command::to_string).collect()
}

fn message(fragment: &str) -> String {
    link::read(fragment).unwrap_err().to_string()
}

#[test]
fn a_link_reads_like_its_commands() {
    let commands =
        ["open builtin:cube", "scheme loop", "level 3", "view edges=bold shading=flat camera=12.5,-4,3.2,0,0,1"];
    let link = link::write(commands);
    assert_eq!(link, "#1;open+builtin:cube;scheme+loop;level+3;view+edges=bold+shading=flat+camera=12.5,-4,3.2,0,0,1");
    assert_eq!(texts(&link), commands);
}

#[test]
fn what_is_not_plain_is_escaped() {
    let name = "open \"file:Stühle & 100%; (neu)+1.obj,12,00000000000000ff\"";
    let link = link::write([name]);
    assert_eq!(link, "#1;open+%22file:St%C3%BChle+%26+100%25%3B+%28neu%29%2B1.obj,12,00000000000000ff%22");
    assert_eq!(texts(&link), [name]);
    // A full stop at the end would be taken for the sentence's.
    assert_eq!(link::write(["export a."]), "#1;export+a%2E");
}

#[test]
fn reading_takes_what_programs_do_to_links() {
    let want = ["open builtin:cube", "level 3"];
    for fragment in [
        "#1;open+builtin:cube;level+3",
        "1;open+builtin:cube;level+3",
        " #1;open+builtin:cube;level+3;\n",
        "#1;open%20builtin%3acube;level%203",
        "#1%3Bopen%2Bbuiltin%3Acube%3Blevel%2B3",
    ] {
        assert_eq!(texts(fragment), want, "{fragment}");
    }
}

#[test]
fn a_broken_link_names_its_part() {
    assert_eq!(link::read("#"), Err(LinkError::Empty));
    assert_eq!(link::read(""), Err(LinkError::Empty));
    assert_eq!(
        message("#open+builtin:cube"),
        "the link begins with `open+builtin:cube` where a version number such as `1;` belongs; copy the whole link again"
    );
    assert!(matches!(link::read("#0;open+builtin:cube"), Err(LinkError::NoVersion(_))));
    assert!(matches!(link::read("#1x;open+builtin:cube"), Err(LinkError::NoVersion(_))));
    assert!(message("#2;open+builtin:cube").starts_with("the link was made by a newer Limn (version 2"));
    assert!(matches!(link::read("#99999999999999999999999;x"), Err(LinkError::Newer(_))));
    assert_eq!(
        message("#1;open+builtin:cube;xyz"),
        "part 2 of the link, `xyz`, is not understood: there is no command `xyz`; `help` lists them"
    );
    assert_eq!(
        message("#1;open+builtin:cube;level+%4"),
        "part 2 of the link, `level+%4`, is damaged: a % code in it is broken; copy the link again"
    );
    assert!(matches!(link::read("#1;open+builtin:%ff"), Err(LinkError::Escape { part: 1, .. })));
    assert_eq!(
        message("#1;open+builtin:cube;export+x.obj"),
        "part 2 of the link, `export x.obj`, is an action; a link only holds a model and how it is shown"
    );
    assert_eq!(link::read("#1"), Err(LinkError::NoSource));
    assert_eq!(link::read("#1;level+3;open+builtin:cube"), Err(LinkError::NoSource));
    assert!(message("#1;open+").starts_with("part 1 of the link, `open `, is not understood"));
    assert!(message(&format!("#1;{}", "é".repeat(200))).chars().count() < 300);
}
